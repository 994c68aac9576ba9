//! Runs cut into shards and put together again.

mod common;

use std::fs;

use common::programs::{Ran, folder, lasting, run_in};
use proptest::prelude::*;
use unbiased::inversion::Exponential;
use unbiased::lambertian::hemisphere::Hemisphere;
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::{Budget, Error, Estimator, Part, Result, Run, from_fn, merge};

fn part(estimator: &dyn Estimator, draws: u64, seed: u64, [k, of]: [u64; 2]) -> Part {
    let outcome = Run::new(seed).shard(k, of).estimate(estimator, Budget::Draws(draws)).unwrap();
    // as a file holds it
    serde_json::from_str(&serde_json::to_string(&outcome.part.unwrap()).unwrap()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any number of shards of any run, in any order, on any number of threads, have the bits of the whole
    /// run, and its cost.
    #[test]
    fn shards_make_the_whole_run(
        draws in prop_oneof![1u64..200, 1u64..70_000, 500_000u64..3_000_000],
        of in 1u64..20,
        turn in 0usize..20,
        paths in any::<bool>(),
    ) {
        let room = BoxRoom::new(Scene::default()).unwrap();
        let path = Paths::new(room, Bounces::All(0.5), Hemisphere::Cosine, FindLight::BySampling).unwrap();
        let exponential = Exponential::new(0.37).unwrap();
        let estimator: &dyn Estimator = if paths && draws < 100_000 { &path } else { &exponential };
        let seed = common::seed(3);
        let mut parts: Vec<Part> = (1..=of).map(|k| part(estimator, draws, seed, [k, of])).collect();
        parts.rotate_left(turn % of as usize);
        let whole = Run::new(seed).threads(1).estimate(estimator, Budget::Draws(draws)).unwrap();
        let merged = merge(&parts).unwrap();
        let bits = |estimate| serde_json::to_string(estimate).unwrap();
        prop_assert_eq!(bits(&merged.estimate), bits(&whole.estimate));
        prop_assert_eq!((merged.cost, merged.seed), (whole.cost, seed));
    }
}

#[test]
fn shards_that_make_no_run_are_refused() {
    let uniform = from_fn(|rng| rng.uniform());
    let [one, two, three] = [1, 2, 3].map(|k| part(&uniform, 10_000, 1, [k, 3]));
    let said = |parts: &[&Part]| {
        merge(&parts.iter().map(|part| (*part).clone()).collect::<Vec<_>>()).unwrap_err().to_string()
    };
    assert_eq!(said(&[]), "the shards do not make a run: there are none");
    assert_eq!(said(&[&one, &three]), "the shards do not make a run: block 13 is missing");
    assert_eq!(said(&[&one, &two]), "the shards do not make a run: block 26 is missing");
    assert_eq!(said(&[&two, &three]), "the shards do not make a run: block 0 is missing");
    assert_eq!(said(&[&one, &two, &two, &three]), "the shards do not make a run: block 13 is there twice");
    let other = part(&uniform, 10_000, 2, [2, 3]);
    assert_eq!(said(&[&one, &other, &three]), "the shards do not make a run: one has seed 2, another 1");
    let other = part(&uniform, 10_001, 1, [2, 3]);
    assert!(said(&[&one, &other, &three]).contains("one is of a run of 10001 draws, another of 10000"));
    let refused = |shard: [u64; 2], budget| -> Result<_> {
        Run::new(1).shard(shard[0], shard[1]).estimate(&uniform, budget)
    };
    for shard in [[0, 3], [4, 3], [1, 0], [0, 0], [u64::MAX, 3]] {
        let error = refused(shard, Budget::Draws(100)).unwrap_err();
        let allowed = "from 1 to the number of shards";
        assert_eq!(error, Error::Count { name: "the shard", value: shard[0], allowed });
    }
    assert!(matches!(refused([1, 3], Budget::StdError(0.1)), Err(Error::Parts { .. })));
    // more shards than blocks: some have nothing to do
    let many: Vec<Part> = (1..=100).map(|k| part(&uniform, 20, 1, [k, 100])).collect();
    assert_eq!(merge(&many).unwrap().estimate.draws(), 20);
    assert!(refused([u64::MAX, u64::MAX], Budget::Draws(20)).is_ok());
}

// ---- the examples' options

#[test]
fn the_rows_of_shards_are_those_of_the_whole() {
    let folder = folder();
    let example = |name: &str, arguments: &[&str]| run_in(&folder, name, arguments, "");
    let rows = |ran: Ran| ran.well().rows().into_iter().map(lasting).collect::<Vec<_>>();
    let refused = |name: &str, arguments: &[&str], sentence: &str| {
        let Ran { code, err, .. } = example(name, arguments);
        assert!(err.contains(sentence) && err.trim().lines().count() == 1, "{arguments:?}: {err}");
        assert_eq!(code, Some(2), "{arguments:?}");
    };
    for (name, own) in
        [("q1_1_exponential", &["--rate", "0.37"][..]), ("q3_6_variance", &[]), ("q5_1_bounces", &[])]
    {
        let common = [own, &["--draws", "5000", "--seed", "7"]].concat();
        let files = [1, 2, 3].map(|k| format!("{name}_{k}.json"));
        for (k, file) in (1..).zip(&files) {
            let shard = format!("{k}/3");
            let printed = example(name, &[&common[..], &["--json", "--shard", &shard]].concat()).well().out;
            fs::write(folder.join(file), printed).unwrap();
        }
        assert!(!folder.join("worksheet").exists(), "a shard draws nothing");
        let files = files.each_ref().map(String::as_str);
        let merged = rows(example(name, &[own, &["--json", "--merge"], &files].concat()));
        let whole = rows(example(name, &[&common[..], &["--json"]].concat()));
        assert!(merged == whole && whole.len() > 1, "{name}");
        let text = example(name, &[own, &["--verbose", "--merge"], &files].concat()).well().out;
        assert!(text.contains("5000 draws"), "{name}");
        fs::remove_dir_all(folder.join("worksheet")).unwrap();
        refused(name, &[own, &["--merge", files[0], files[1]]].concat(), "is missing");
        refused(
            name,
            &[own, &["--merge", files[0], files[0], files[1], files[2]]].concat(),
            "is there twice",
        );
    }
    let files = [1, 2, 3].map(|k| format!("q1_1_exponential_{k}.json"));
    let files = files.each_ref().map(String::as_str);
    let other_rate = [&["--rate", "2", "--merge"], &files[..]].concat();
    let other_example = [&["--merge"], &files[..]].concat();
    for (name, arguments, sentence) in [
        ("q1_1_exponential", &["--shard", "0/3", "--json"][..], "--shard takes one of 1/N to N/N"),
        ("q1_1_exponential", &["--shard", "4/3", "--json"], "--shard takes one of 1/N to N/N"),
        ("q1_1_exponential", &["--shard", "1/3"], "--shard needs --json"),
        (
            "q1_1_exponential",
            &["--shard", "1/3", "--json", "--seconds", "1"],
            "--shard excludes --error and --seconds",
        ),
        ("q1_1_exponential", &["--merge", "nowhere.json"], "nowhere.json"),
        ("q1_1_exponential", &other_rate, "another example or other options"),
        ("q3_6_variance", &other_example, "another example or other options"),
        ("q1_1_exponential", &["--merge", files[0], "q5_1_bounces_2.json"], "than the others"),
    ] {
        refused(name, arguments, sentence);
    }
}
