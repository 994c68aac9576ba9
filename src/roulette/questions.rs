//! The questions of section 5, Russian roulette.

use crate::question::{Letter, Number, Parameter, Question, Value, Wrong};
use crate::question::{classic, slip};
use crate::roulette::{LightModel, Roulette};

const ALBEDO: Parameter = Parameter {
    name: "albedo",
    default: Value::Number(0.8),
    help: "the albedo ρ of every vertex, in [0, 1)",
    variants: &[0.3, 0.35, 0.4, 0.45, 0.55, 0.6, 0.65, 0.7, 0.75, 0.85, 0.9],
    letter: Some(Letter {
        names: &["ρ", "rho"],
        value: |values| LightModel::new(values.number("albedo"), 1.0).map(|model| model.albedo()),
        generic: 0.61,
    }),
};
const VISIBILITY: Parameter = Parameter {
    name: "visibility",
    default: Value::Number(0.5),
    help: "the probability v that a vertex sees the light, in [0, 1]",
    variants: &[0.2, 0.25, 0.3, 0.4, 0.6, 0.7, 0.75],
    letter: Some(Letter {
        names: &["v"],
        value: |values| LightModel::new(0.0, values.number("visibility")).map(|model| model.visibility()),
        generic: 0.37,
    }),
};
const P_RR: Parameter = Parameter {
    name: "p-rr",
    default: Value::Number(0.8),
    help: "the continuation probability p_rr in (0, 1)",
    variants: &[0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9],
    letter: Some(Letter {
        names: &["p_rr", "prr", "p", "q"],
        value: |values| Roulette::new(values.number("p-rr")).map(|roulette| roulette.p_rr()),
        generic: 0.83,
    }),
};

const EXPECTED_BOUNCES: Number = Number {
    part: "",
    symbol: "E[N]",
    what: "the expected number of bounces E[N]",
    formula: "p_rr/(1 − p_rr)",
    over_n: None,
    slips: &[
        classic("coins", "1/(1 − p_rr)", "1/(1 − p) counts coins, N + 1: subtract 1"),
        classic("exchanged", "(1 − p_rr)/p_rr", "p and 1 − p exchanged"),
        classic("exchanged-coins", "1/p_rr", "p and 1 − p exchanged, and no 1 subtracted"),
        classic("first", "p_rr", "p itself: the first bounce alone"),
        slip("end", "1 − p_rr", "1 − p, the chance of ending"),
        slip("variance", "p_rr/(1 − p_rr)²", "the variance p/(1 − p)²"),
        slip("minus-two", "1/(1 − p_rr) − 2", "1 subtracted twice"),
        slip("plus-one", "1/(1 − p_rr) + 1", "1 added instead of subtracted"),
    ],
};

pub(crate) const QUESTIONS: &[Question] = &[
    Question {
        id: "5.1",
        title: "Bounces at p_rr = «p_rr»",
        statement: "With Russian roulette a ray goes on with probability p_rr at every step, and X becomes \
                    X/p_rr if it does and 0 if not. Let p_rr = «p_rr», and N ≥ 0 the number of bounces. (i) \
                    What is P(N = 0)? (ii) What is P(N = 2)? (iii) What is E[N]?",
        hint: "N = k means going on k times and then stopping. For E[N], count the trials up to the first \
               stop, and then do not count the stop.",
        formula: "P(N = k) = p_rr^k (1 − p_rr): «1 − p_rr» for k = 0, «p_rr² (1 − p_rr)» for k = 2; E[N] = \
                  p_rr/(1 − p_rr) = «p_rr/(1 − p_rr)»",
        latex: &[
            r"P(N = k) = p_{rr}^k\,(1 - p_{rr})",
            r"P(N=0) = «1 − p_rr», \qquad P(N=2) = «p_rr»^2 \cdot «1 − p_rr» = «p_rr² (1 − p_rr)»",
            r"E[N] = \frac{1}{1 - p_{rr}} - 1 = \frac{p_{rr}}{1 - p_{rr}} = «p_rr/(1 − p_rr)»",
        ],
        answer: "N = k means going on k times and then stopping. N + 1 counts trials up to the first stop, \
                 which has probability 1 − p_rr, so its mean is 1/(1 − p_rr) = «1/(1 − p_rr)». The division \
                 by p_rr compensates for the rays that stop: E[X_rr] = p_rr · E[X]/p_rr = E[X], if the coin \
                 is independent of X. The same law is drawn in one step by inversion, N = ⌊ln(1 − U)/ln \
                 p_rr⌋.",
        numbers: &[
            Number {
                part: "(i)",
                symbol: "P(N = 0)",
                what: "the probability P(N = 0)",
                formula: "1 − p_rr",
                over_n: None,
                slips: &[
                    slip("goes-on", "p_rr", "the chance of going on, not of ending"),
                    slip("one-bounce", "p_rr (1 − p_rr)", "one bounce and then the end: that is N = 1"),
                    slip("no-end", "1", "p⁰ = 1: the factor 1 − p for the end is missing"),
                    slip("never", "0", "a path that ends at once has N = 0, which is possible"),
                    slip("two-bounces", "p_rr²", "p², the chance of two bounces or more"),
                ],
            },
            Number {
                part: "(ii)",
                symbol: "P(N = 2)",
                what: "the probability P(N = 2)",
                formula: "p_rr² (1 − p_rr)",
                over_n: None,
                slips: &[
                    classic("no-end", "p_rr²", "p²: the factor 1 − p for the end is missing"),
                    slip("exchanged", "(1 − p_rr)² p_rr", "p and 1 − p exchanged"),
                    slip(
                        "one-bounce",
                        "p_rr (1 − p_rr)",
                        "p(1 − p), that is N = 1: coins counted instead of bounces",
                    ),
                    slip(
                        "three-bounces",
                        "p_rr³ (1 − p_rr)",
                        "p³(1 − p), that is N = 3: one bounce too many",
                    ),
                    slip("cube", "p_rr³", "p³: one bounce too many, and the end is missing"),
                    slip(
                        "binomial",
                        "3 p_rr² (1 − p_rr)",
                        "the binomial 3p²(1 − p): the end comes last, in one way only",
                    ),
                    slip(
                        "exchanged-no-end",
                        "(1 − p_rr)²",
                        "(1 − p)²: p and 1 − p exchanged, the end missing",
                    ),
                    slip("at-most", "1 − p_rr³", "P(N ≤ 2), not P(N = 2)"),
                    slip("twice", "2 p_rr² (1 − p_rr)", "2p²(1 − p): the order is fixed, it counts once"),
                ],
            },
            Number { part: "(iii)", ..EXPECTED_BOUNCES },
        ],
        wrong: &[],
        on_the_original: Some(
            "p_rr must lie in (0, 1], since p_rr = 0 loses all light, and the coin must be independent of X; \
             the original says neither. “Geometric” counts trials there (mean 1/p), and failures in some \
             libraries (mean 1/p − 1): check which one a library means.",
        ),
        example: "q5_1_bounces",
        lines: 6,
        parameters: &[P_RR],
        derived: &[],
    },
    Question {
        id: "5.2",
        title: "A smaller p_rr: «p_rr»",
        statement: "With p_rr = «p_rr», what is the expected number of bounces E[N]?",
        hint: "The same as 5.1(iii), with another p_rr.",
        formula: "E[N] = p_rr/(1 − p_rr) = «p_rr/(1 − p_rr)»",
        latex: &[r"E[N] = \frac{1}{1 - «p_rr»} - 1 = «1/(1 − p_rr)» - 1 = «p_rr/(1 − p_rr)»"],
        answer: "A share «1 − p_rr» of the rays stops at once. That is cheap, and it stays unbiased; but \
                 with an albedo of «ρ» every bounce that is taken weighs ρ/p_rr = «ρ/p_rr» times as much as \
                 the one before, and where p_rr ≤ ρ² = «ρ²» the variance is infinite: the mean of a thousand \
                 such paths is then usually too dark, its error bar too short.",
        numbers: &[EXPECTED_BOUNCES],
        wrong: &[],
        on_the_original: None,
        example: "q5_2_few_bounces",
        lines: 2,
        parameters: &[Parameter { default: Value::Number(0.2), ..P_RR }, ALBEDO, VISIBILITY],
        derived: &[],
    },
    Question {
        id: "5.3",
        title: "Bounces against p_rr",
        statement: "How does a larger p_rr change the expected number of bounces E[N]?",
        hint: "Write E[N] as a function of p_rr, and let p_rr go to 1.",
        formula: "E[N] = p_rr/(1 − p_rr) grows with p_rr, without bound; Var N = p_rr/(1 − p_rr)²",
        latex: &[
            r"E[N] = \frac{p_{rr}}{1-p_{rr}}, \qquad \operatorname{Var} N = \frac{p_{rr}}{(1-p_{rr})^2}",
            r"\operatorname{Var}\hat L = \frac{A(1-q)+Bq}{q-\rho^2}\ (q > \rho^2), \quad \text{cost}
              = \frac1{1-q}, \quad A = \frac{v^2\rho^2}{(1-\rho)^2},\ B = v(1-v)",
        ],
        answer: "It grows, slowly at first and without bound as p_rr → 1, and its standard deviation is \
                 always larger. A model shows what that gains: at each vertex the path sees the light with \
                 probability v = «v», a fraction ρ = «ρ» is reflected, and q is p_rr. A larger q lowers the \
                 variance and raises the cost, and their product is least at q*, between ρ and 1. Stopping \
                 after a fixed number of bounces instead is biased: cheaper at first, overtaken by roulette \
                 later.",
        numbers: &[],
        wrong: &[
            Wrong { answer: "it lowers E[N]", slip: "p_rr is the probability of going on, not of stopping" },
            Wrong {
                answer: "E[N] is proportional to p_rr",
                slip: "only for small p_rr: from 1/2 to 3/4 it goes from 1 to 3",
            },
            Wrong {
                answer: "it removes bias",
                slip: "roulette is unbiased for every p_rr > 0; p_rr changes variance and cost",
            },
        ],
        on_the_original: None,
        example: "q5_3_more_bounces",
        lines: 3,
        parameters: &[
            Parameter { help: "the continuation probability q of the paths, in (0, 1)", ..P_RR },
            ALBEDO,
            VISIBILITY,
            Parameter {
                name: "max-k",
                default: Value::Number(8.0),
                help: "the last vertex of truncated paths",
                variants: &[4.0, 6.0, 10.0, 12.0],
                letter: None,
            },
        ],
        derived: &[],
    },
];
