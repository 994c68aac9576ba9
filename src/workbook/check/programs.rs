//! Output for programs in other languages: the probes in words and numbers, and a template program.

use serde_json::{Map, Value, json};

use crate::check::{Exercise, Given, Probe};
use crate::error::{Error, Result};
use crate::numbers::shortened;

/// A question's probes: comment lines with a #, then one line for each probe, its number first.
pub fn probes(exercise: &Exercise, question: &str) -> String {
    let probes = exercise.probes_of(question);
    let names = |probe: &&Probe| probe.given.iter().map(|(name, _)| format!(" {name}")).collect::<String>();
    let values = |probe: &Probe| probe.given.iter().map(|(_, given)| format!(" {given}")).collect::<String>();
    let mut lines = vec![format!("# Question {question}, {}", exercise.name)];
    lines.extend(exercise.draw.lines().map(|line| format!("# {line}")));
    lines.push("# The probes:".into());
    for (number, probe) in (1..).zip(&probes) {
        lines.push(format!("#   {number}. {probe}: the truth is {}", shortened(probe.truth)));
    }
    lines.push(format!("# probe{}", probes.first().map(names).unwrap_or_default()));
    lines.extend((1..).zip(&probes).map(|(number, probe)| format!("{number}{}", values(probe))));
    lines.join("\n")
}

/// The same as JSON Lines.
pub fn probes_json(exercise: &Exercise, question: &str) -> String {
    let line = |(number, probe): (usize, &&Probe)| {
        let given = probe.given.iter().map(|(name, given)| {
            let value = match given {
                Given::Number(number) => json!(number),
                Given::Word(word) => json!(word),
            };
            ((*name).to_owned(), value)
        });
        let given: Map<String, Value> = given.collect();
        json!({
            "question": question, "probe": number, "what": probe.to_string(), "draw": exercise.draw,
            "parameters": given, "truth": probe.truth,
        })
        .to_string()
    };
    let lines: Vec<String> = (1..).zip(&exercise.probes_of(question)).map(line).collect();
    lines.join("\n")
}

/// A language with a template program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Language {
    Python,
    Cpp,
}

impl Language {
    pub fn read(name: &str) -> Result<Self> {
        match name.to_lowercase().as_str() {
            "python" | "py" => Ok(Self::Python),
            "cpp" | "c++" => Ok(Self::Cpp),
            _ => Err(Error::Usage(format!("--template is python or cpp, not \"{name}\""))),
        }
    }
}

/// A program that reads the question's probes and writes a probe's number and a draw per line, with a place
/// for the reader's estimator.
pub fn template(exercise: &Exercise, question: &str, language: Language) -> Result<String> {
    let Some(parts) = PARTS.iter().find(|parts| parts.exercise == exercise.id) else {
        return Err(Error::Usage(format!("question {question} has no template program")));
    };
    let (frame, part) = match language {
        Language::Python => (PYTHON, &parts.python),
        Language::Cpp => (CPP, &parts.cpp),
    };
    let given = exercise.probes.first().map_or(&[][..], |probe| &probe.given);
    let (mut names, mut declared, mut taken, mut read) = (vec![], vec![], vec![], String::new());
    for (place, (name, value)) in (1..).zip(given) {
        let number = matches!(value, Given::Number(_));
        names.push(*name);
        declared.push(format!("{} {name}", if number { "double" } else { "std::string" }));
        taken.push(if number { format!("float(word[{place}])") } else { format!("word[{place}]") });
        read += &format!(" >> {name}");
    }
    let text = frame
        .replace("QUESTION", question)
        .replace("HELPERS", part.helpers)
        .replace("ESTIMATOR", part.estimator)
        .replace("DECLARED_HERE", &declared.join("; "))
        .replace("DECLARED", &declared.join(", "))
        .replace("READ", &read)
        .replace("GIVEN", &taken.join(", "))
        .replace("NAMES", &names.join(", "));
    Ok(text.trim_end().into())
}

/// The parts that differ between exercises.
struct Parts {
    exercise: &'static str,
    python: Part,
    cpp: Part,
}

struct Part {
    helpers: &'static str,
    /// The estimator to be replaced, a classic mistake.
    estimator: &'static str,
}

const PYTHON: &str = r##"# CHECK is cargo run --release --example check_mine -- --question QUESTION
#   CHECK --probes | python3 mine.py | CHECK --draws-from -
import math, random, sys

HELPERS
def draw(NAMES):
    # ---- your estimator: one draw (this one makes a classic mistake) ----
ESTIMATOR
    # ----------------------------------------------------------------------

random.seed(1)
for line in sys.stdin:
    if not line.startswith("#"):
        word = line.split()
        for _ in range(100000):
            print(word[0], draw(GIVEN))
"##;

const CPP: &str = r##"// CHECK is cargo run --release --example check_mine -- --question QUESTION
//   c++ -O2 -o mine mine.cpp && CHECK --probes | ./mine | CHECK --draws-from -
#include <cmath>
#include <iostream>
#include <random>
#include <sstream>
#include <string>

std::mt19937_64 generator(1);
double uniform() { return (generator() >> 11) / 9007199254740992.0; }
HELPERS
double draw(DECLARED) {
    // ---- your estimator: one draw (this one makes a classic mistake) ----
ESTIMATOR
    // ----------------------------------------------------------------------
}

int main() {
    std::cout.precision(17);
    for (std::string line; std::getline(std::cin, line);) {
        int probe; DECLARED_HERE;
        if (line[0] == '#' || !(std::istringstream(line) >> probeREAD)) continue;
        for (int i = 0; i < 100000; i++) std::cout << probe << ' ' << draw(NAMES) << '\n';
    }
}
"##;

const PARTS: [Parts; 5] = [
    Parts {
        exercise: "samples",
        python: Part {
            helpers: r#"AVERAGE = {"x": lambda x, rate: x,
           "cdf": lambda x, rate: -math.expm1(-rate * max(x, 0)),
           "capped": lambda x, rate: min(max(x, 0), 2 / rate)}
"#,
            estimator: r#"    u = random.random()
    x = -rate * math.log(1 - u)
    return AVERAGE[average](x, rate)"#,
        },
        cpp: Part {
            helpers: r#"double value(std::string average, double x, double rate) {
    if (average == "x") return x;
    return average == "cdf" ? -std::expm1(-rate * std::fmax(x, 0)) : std::fmin(std::fmax(x, 0), 2 / rate);
}
"#,
            estimator: r#"    double x = -rate * std::log(1 - uniform());
    return value(average, x, rate);"#,
        },
    },
    Parts {
        exercise: "integral",
        python: Part {
            helpers: r#"F = {"one": lambda x, y: 1, "squares": lambda x, y: x * x + y * y,
     "product": lambda x, y: x * y, "plane": lambda x, y: x + 2 * y}
"#,
            estimator: r#"    u, v = random.random(), random.random()
    x, y = a + (b - a) * u, c + (d - c) * v
    return (b - a) * F[f](x, y)"#,
        },
        cpp: Part {
            helpers: r#"double value(std::string f, double x, double y) {
    return f == "one" ? 1 : f == "squares" ? x * x + y * y : f == "product" ? x * y : x + 2 * y;
}
"#,
            estimator: r#"    double u = uniform(), v = uniform();
    double x = a + (b - a) * u, y = c + (d - c) * v;
    return (b - a) * value(f, x, y);"#,
        },
    },
    Parts {
        exercise: "reflection",
        python: Part {
            helpers: r#"LIGHT = {"one": lambda x, y, z: 1, "cos": lambda x, y, z: z,
         "cos2": lambda x, y, z: z * z,
         "half": lambda x, y, z: 2 if y >= 0 else 0,
         "lobe": lambda x, y, z: 4 if y >= 0 and z * z > 0.5 else 0,
         "grazing": lambda x, y, z: 16 if z < 0.25 else 0}
"#,
            estimator: r#"    z, phi = 1 - random.random(), 2 * math.pi * random.random()
    x, y = math.sqrt(1 - z * z) * math.cos(phi), math.sqrt(1 - z * z) * math.sin(phi)
    return albedo * LIGHT[light](x, y, z)"#,
        },
        cpp: Part {
            helpers: r#"double radiance(std::string light, double x, double y, double z) {
    if (light == "half" || light == "lobe") return y < 0 ? 0 : light == "half" ? 2 : z * z > 0.5 ? 4 : 0;
    return light == "one" ? 1 : light == "cos" ? z : light == "cos2" ? z * z : z < 0.25 ? 16 : 0;
}
"#,
            estimator: r#"    double z = uniform(), r = sqrt(1 - z * z), phi = 6.283185307179586 * uniform();
    return albedo * radiance(light, r * std::cos(phi), r * std::sin(phi), z);"#,
        },
    },
    Parts {
        exercise: "roulette",
        python: Part {
            helpers: "",
            estimator: r#"    x = 0.5 + random.random()
    return x if random.random() < p_rr else 0"#,
        },
        cpp: Part {
            helpers: "",
            estimator: r#"    double x = 0.5 + uniform();
    return uniform() < p_rr ? x : 0;"#,
        },
    },
    Parts {
        exercise: "bounces",
        python: Part {
            helpers: "",
            estimator: r#"    n = 1
    while random.random() < p_rr:
        n += 1
    return n"#,
        },
        cpp: Part {
            helpers: "",
            estimator: r#"    int n = 1;
    while (uniform() < p_rr) n++;
    return n;"#,
        },
    },
];
