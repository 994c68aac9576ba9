//! The questions of section 3, the diffuse cube.

use crate::error::require;
use crate::lambertian::{CosinePower, Lambertian, RingLight};
use crate::question::{Letter, Number, Parameter, Question, Value, Wrong};
use crate::question::{classic, slip};

const ALBEDO: Parameter = Parameter {
    name: "albedo",
    default: Value::Number(0.8),
    help: "the albedo ρ in [0, 1]",
    variants: &[0.3, 0.35, 0.4, 0.45, 0.55, 0.6, 0.65, 0.7, 0.75, 0.85, 0.9],
    letter: Some(Letter {
        names: &["ρ", "rho"],
        value: |values| Lambertian::new(values.number("albedo")).map(Lambertian::albedo),
        generic: 0.61,
    }),
};
const RADIANCE: Parameter = Parameter {
    name: "radiance",
    default: Value::Number(1.0),
    help: "the incoming radiance, in W m⁻² sr⁻¹",
    variants: &[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 12.0, 15.0, 20.0],
    letter: Some(L_I),
};
const L_I: Letter = Letter {
    names: &["L_i", "Li", "L"],
    value: |values| {
        let radiance = values.number("radiance");
        require("the radiance", radiance, radiance.is_finite(), "finite")
    },
    generic: 1.7,
};
const A: Parameter = Parameter {
    name: "a",
    default: Value::Number(1.0),
    help: "the exponent of the light cos^a θ, above -2",
    variants: &[0.5, 1.5, 2.0, 2.5, 3.0, 4.0],
    letter: Some(Letter {
        names: &["a"],
        value: |values| CosinePower::new(values.number("a")).map(|sky| sky.a()),
        generic: 0.43,
    }),
};

pub(crate) const QUESTIONS: &[Question] = &[
    Question {
        id: "3.1",
        title: "What the cube emits",
        statement: "A wooden cube scatters light diffusely: its BRDF is f_r = ρ/π. Outgoing radiance is \
                    emitted plus reflected radiance, L_o = L_e + L_r with L_r = ∫ f_r L_i cos θ dω over the \
                    hemisphere. What is the cube's emitted radiance L_e?",
        hint: "Does wood emit light?",
        formula: "L_e = 0",
        latex: &[
            r"L_o(\mathbf p, \omega_o)
              = L_e(\mathbf p, \omega_o) + \int_{H^2} f_r\, L_i(\mathbf p, \omega)\cos\theta\,d\omega",
            r"L_e = 0",
        ],
        answer: "Wood does not emit light: all light that leaves the cube came from elsewhere, so its \
                 outgoing radiance is the reflected radiance.",
        numbers: &[Number {
            part: "",
            symbol: "L_e",
            what: "the emitted radiance",
            formula: "0",
            over_n: None,
            slips: &[
                classic("reflected", "ρ or ρ L_i", "ρ says what is reflected, not what is emitted"),
                slip("one", "1 or L_i", "wood does not glow: what it reflects is not emitted"),
            ],
        }],
        wrong: &[],
        on_the_original: Some(
            "The original calls the sum with L_e in it reflected radiance. Outgoing radiance is the sum, L_o \
             = L_e + L_r; reflected radiance is the integral.",
        ),
        example: "q3_1_emission",
        lines: 1,
        parameters: &[ALBEDO],
        derived: &[Letter { value: |_| Ok(1.0), ..L_I }],
    },
    Question {
        id: "3.2",
        title: "Under a uniform sky",
        statement: "The incoming radiance L_i is the same from every direction of the hemisphere above p, on \
                    the cube's top face. What is the reflected radiance L_r? (Write dω in terms of θ and \
                    φ.)",
        hint: "dω = sin θ dθ dφ. Substitute u = sin θ.",
        formula: "L_r = ρ L_i = «ρ L_i»",
        latex: &[r"L_r = \frac{\rho}{\pi} L_i \int_0^{2\pi}\!\! d\varphi \int_0^{\pi/2} \cos\theta
              \sin\theta\, d\theta = \frac{\rho}{\pi} L_i \cdot 2\pi \cdot \frac12 = \rho L_i = «ρ L_i»"],
        answer: "A solid angle is dω = sin θ dθ dφ, so the integrand is cos θ sin θ, whose integral over θ \
                 is ½. The π of the BRDF is there to cancel the π that is left: a white surface (ρ = 1) \
                 under a uniform sky is as bright as the sky.",
        numbers: &[Number {
            part: "",
            symbol: "L_r",
            what: "the reflected radiance L_r",
            formula: "ρ L_i",
            over_n: None,
            slips: &[
                classic("no-sine", "2ρ L_i", "sin θ or cos θ forgotten in the integral"),
                classic("no-pi", "π ρ L_i", "the 1/π of the BRDF forgotten"),
                classic(
                    "half-turn",
                    "ρ L_i/2",
                    "φ over half a turn only, or ∫ sin θ cos θ dθ = ½ without its 2",
                ),
                slip(
                    "brdf",
                    "ρ L_i/π or ρ/π",
                    "the BRDF alone: the integral of cos θ over the hemisphere is π, not 1",
                ),
                slip("no-pi-no-sine", "2π ρ L_i", "the 1/π of the BRDF forgotten, and cos θ or sin θ"),
                slip("cosine-twice", "2ρ L_i/3", "cos θ twice"),
                slip("cosine-for-sine", "π ρ L_i/2", "∫ cos² θ dθ: cos θ put for sin θ in the measure"),
                slip("no-albedo", "L_i", "ρ forgotten"),
                slip("no-brdf", "π L_i", "ρ/π forgotten"),
                slip("no-sine-no-cosine", "π² ρ L_i", "neither sin θ nor cos θ, nor the BRDF's 1/π"),
                slip("no-radiance", "ρ", "L_i forgotten: that is L_r/L_i"),
                slip("emitted", "0", "that is L_e, the emitted radiance"),
            ],
        }],
        wrong: &[],
        on_the_original: None,
        example: "q3_2_uniform_sky",
        lines: 5,
        parameters: &[ALBEDO, RADIANCE],
        derived: &[],
    },
    Question {
        id: "3.3",
        title: "What reflected radiance depends on",
        statement: "How does the reflected radiance depend on the direction ω_o towards the eye? How does it \
                    depend on ρ?",
        hint: "Look for ω_o in the BRDF ρ/π, and for ρ in the answer to 3.2.",
        formula: "L_r does not depend on ω_o, and is proportional to ρ in [0, 1]",
        latex: &[r"\frac{\partial L_r}{\partial \omega_o} = 0, \qquad L_r \propto \rho"],
        answer: "The BRDF ρ/π does not depend on ω_o: that is what makes the surface Lambertian, equally \
                 bright from every side. ρ, the albedo, is the share of the incoming power that is \
                 reflected; above 1 the surface would create energy.",
        numbers: &[],
        wrong: &[
            Wrong {
                answer: "L_r ∝ cos θ_o",
                slip: "the power sent into a direction falls with cos θ_o, but so does the area seen from \
                       there: radiance stays",
            },
            Wrong {
                answer: "L_r = ρ/π",
                slip: "the BRDF is not yet the radiance: the integral over the sky brings π back",
            },
        ],
        on_the_original: None,
        example: "q3_3_dependence",
        lines: 3,
        parameters: &[ALBEDO, RADIANCE],
        derived: &[],
    },
    Question {
        id: "3.4",
        title: "Directions in proportion to the BRDF",
        statement: "The incoming radiance is no longer uniform. To estimate L_r, n directions are drawn over \
                    the hemisphere from a density p(ω) proportional to the BRDF. Write down the Monte Carlo \
                    estimator.",
        hint: "A density in proportion to a constant is a constant, and it integrates to 1 over the \
               hemisphere's 2π steradians.",
        formula: "L̂_r = 1/n Σ (ρ/π) L_i cos θ / (1/2π) = 2ρ/n Σ L_i(ω_j) cos θ_j",
        latex: &[r"\hat L_r
              = \frac1n \sum_{j=1}^n \frac{\frac{\rho}{\pi} L_i(\omega_j)\cos\theta_j}{\frac{1}{2\pi}}
              = \frac{2\rho}{n}\sum_{j=1}^n L_i(\omega_j)\cos\theta_j"],
        answer: "The BRDF ρ/π is constant, so a density proportional to it is constant too, and integrates \
                 to 1 over the hemisphere's 2π steradians: p = 1/(2π). Each draw is the integrand over the \
                 density. The incoming radiance here is L cos^a θ with a = «a», for which L_r is 2ρL/(a + 2) \
                 = «2ρ L/(a + 2)».",
        numbers: &[Number {
            part: "",
            symbol: "c",
            what: "the factor c",
            formula: "2ρ",
            over_n: Some("c/n Σ L_i cos θ"),
            slips: &[
                classic(
                    "whole-sphere",
                    "4ρ",
                    "the pdf taken for 1/(4π), the whole sphere's: twice the truth",
                ),
                slip("one-over-pi", "ρ", "the pdf taken for 1/π: over the hemisphere it is 1/(2π)"),
                slip("no-pi", "2π ρ", "the 1/π of the BRDF forgotten"),
                slip("pi-twice", "2ρ/π", "1/π twice"),
                slip("no-pdf", "ρ/π", "no division by the pdf"),
                slip("times-pdf", "ρ/(2π²)", "multiplied by the pdf instead of divided"),
                slip("no-albedo", "2", "ρ forgotten"),
                slip("no-brdf", "2π", "the BRDF forgotten"),
            ],
        }],
        wrong: &[
            Wrong {
                answer: "ρ/n Σ L_i",
                slip: "the density cos θ/π in the formula while directions are uniform: right under a \
                       constant light, 3/4 of the truth under cos θ",
            },
            Wrong {
                answer: "2ρ/n Σ L_i",
                slip: "cos θ forgotten: twice the truth under a constant light, 3/2 under cos θ",
            },
            Wrong {
                answer: "θ = πU/2",
                slip: "θ drawn uniformly instead of cos θ crowds the pole: 4/π and 3/2 times the truth",
            },
        ],
        on_the_original: Some(
            "“Proportional to the BRDF” means to f_r alone, not to f_r cos θ; that is the next question.",
        ),
        example: "q3_4_brdf_directions",
        lines: 4,
        parameters: &[ALBEDO, RADIANCE, A],
        derived: &[],
    },
    Question {
        id: "3.5",
        title: "Cosine-weighted directions",
        statement: "In practice directions are drawn with density p(ω) = cos θ/π. What is the estimator for \
                    n directions now?",
        hint: "Divide the same integrand by the new density, and simplify.",
        formula: "L̂_r = ρ/n Σ L_i(ω_j)",
        latex: &[r"\hat L_r
              = \frac1n \sum_{j=1}^n \frac{\frac{\rho}{\pi}
              L_i(\omega_j)\cos\theta_j}{\frac{\cos\theta_j}{\pi}}
              = \frac{\rho}{n}\sum_{j=1}^n L_i(\omega_j)"],
        answer: "The cosine and the π cancel. Simplify before computing: at cos θ = 0 the quotient would be \
                 0/0. The directions must be drawn from the new density, cos θ = √(1 − U); changing the \
                 formula alone is the classic mistake.",
        numbers: &[Number {
            part: "",
            symbol: "c",
            what: "the factor c",
            formula: "ρ",
            over_n: Some("c/n Σ L_i"),
            slips: &[
                slip("uniform", "2ρ", "the uniform estimator's factor: here p = cos θ/π"),
                slip("no-pi", "π ρ", "the 1/π of the BRDF forgotten"),
                slip("no-pdf", "ρ/π", "the pdf's 1/π forgotten, or no division by the pdf"),
                slip("times-pdf", "ρ/π²", "multiplied by the pdf instead of divided"),
                slip("no-albedo", "1", "ρ forgotten"),
                slip("no-brdf", "π", "the BRDF forgotten"),
            ],
        }],
        wrong: &[
            Wrong {
                answer: "ρ/n Σ L_i with uniform directions",
                slip: "only the formula was changed: a constant light cannot show it, cos θ gives 3/4 of the \
                       truth",
            },
            Wrong {
                answer: "2ρ/n Σ L_i cos θ with cosine directions",
                slip: "only the directions were changed: 4/3 and 3/2 times the truth",
            },
            Wrong {
                answer: "ρ/n Σ L_i cos θ",
                slip: "cos θ counted twice, in the directions and in the weight: 2/3 and 3/4 of the truth",
            },
        ],
        on_the_original: None,
        example: "q3_5_cosine_directions",
        lines: 4,
        parameters: &[ALBEDO, RADIANCE, A],
        derived: &[],
    },
    Question {
        id: "3.6",
        title: "Which directions are better",
        statement: "Why, conceptually, does cosine-weighted sampling of the hemisphere do better than \
                    uniform sampling?",
        hint: "What is the variance of f/p if p is exactly proportional to f? And where would the light have \
               to come from for cos θ/π to be a poor choice?",
        formula: "under cos^a θ: Var uniform = 4ρ²(a+1)²/((2a+3)(a+2)²), Var cosine = ρ²a²/((a+1)(a+2)²)",
        latex: &[
            r"\operatorname{Var}\frac{f(X)}{p(X)} = \int \frac{f^2}{p} - \left(\int f\right)^2",
            r"V_\text{uniform} = \frac{4\rho^2(a+1)^2}{(2a+3)(a+2)^2}, \qquad V_\text{cosine}
              = \frac{\rho^2a^2}{(a+1)(a+2)^2}",
        ],
        answer: "The rate 1/√n is the same; the constant is smaller when the density is close to the \
                 integrand's shape, and the integrand has a factor cos θ. The variance is 0 exactly when p \
                 is proportional to an integrand of one sign: cosine under a uniform sky. But cosine does \
                 not always win: for the incoming radiance cos^a θ both are equal at a = −½, and as a → −1 \
                 uniform directions have no variance and cosine ones an infinite one. With light only along \
                 the horizon, cos θ < ε, cosine's variance is the larger for ε < ¾, and «(1 − ε²)/(4ε/3 − \
                 ε²)» times uniform's at ε = «ε».",
        numbers: &[],
        wrong: &[
            Wrong {
                answer: "it converges at a better rate",
                slip: "both errors fall as 1/√n; only the constant differs",
            },
            Wrong { answer: "it is always better", slip: "not where the light comes from near the horizon" },
            Wrong {
                answer: "it avoids wasted samples, so it is less biased",
                slip: "both are unbiased; wasted samples increase the variance",
            },
        ],
        on_the_original: Some(
            "The original says that cosine-weighted sampling outperforms uniform sampling; it does for \
             lights that do not favour the horizon.",
        ),
        example: "q3_6_variance",
        lines: 4,
        parameters: &[
            ALBEDO,
            A,
            Parameter {
                name: "width",
                default: Value::Number(0.1),
                help: "the width ε of the ring of light cos θ ≤ ε, in (0, 1]",
                variants: &[0.05, 0.15, 0.2, 0.25, 0.3, 0.4],
                letter: Some(Letter {
                    names: &["ε", "epsilon"],
                    value: |values| RingLight::new(values.number("width")).map(|ring| ring.width()),
                    generic: 0.17,
                }),
            },
        ],
        derived: &[],
    },
];
