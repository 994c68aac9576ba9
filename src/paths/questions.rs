//! The questions of section 4, paths in the box room.

use crate::error::Result;
use crate::paths::room::{BoxRoom, Scene};
use crate::question::{Letter, Parameter, Question, Value, Values, Wrong};

/// The scene that these values describe.
pub(crate) fn scene(values: &Values) -> Scene {
    let point = match values.value("point") {
        Some(Value::Point(point)) => point,
        _ => [f64::NAN; 3],
    };
    Scene {
        wall_albedo: values.number("wall-albedo"),
        cube_albedo: values.number("cube-albedo"),
        radiance: values.number("radiance"),
        light_half_width: values.number("light-half-width"),
        point,
        ..Scene::default()
    }
}

/// The room, if all of its numbers are in their domains.
fn room(values: &Values) -> Result<Scene> {
    BoxRoom::new(scene(values)).map(|room| *room.scene())
}

const WALL_ALBEDO: Parameter = Parameter {
    name: "wall-albedo",
    default: Value::Number(0.5),
    help: "the albedo ρ of walls, floor and ceiling, in [0, 1]",
    variants: &[0.3, 0.35, 0.4, 0.45, 0.55, 0.6, 0.65, 0.7],
    letter: Some(Letter {
        names: &["ρ_wall"],
        value: |values| room(values).map(|scene| scene.wall_albedo),
        generic: 0.61,
    }),
};
const CUBE_ALBEDO: Parameter = Parameter {
    name: "cube-albedo",
    default: Value::Number(0.8),
    help: "the albedo ρ of the cube, in [0, 1]",
    variants: &[0.25, 0.55, 0.6, 0.65, 0.75, 0.85, 0.9],
    letter: Some(Letter {
        names: &["ρ_cube"],
        value: |values| room(values).map(|scene| scene.cube_albedo),
        generic: 0.37,
    }),
};
const RADIANCE: Parameter = Parameter {
    name: "radiance",
    default: Value::Number(10.0),
    help: "the light's radiance L_e, in W m⁻² sr⁻¹",
    variants: &[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 12.0, 15.0, 20.0],
    letter: Some(Letter {
        names: &["L_e"],
        value: |values| room(values).map(|scene| scene.radiance),
        generic: 7.0,
    }),
};
const LIGHT_HALF_WIDTH: Parameter = Parameter {
    name: "light-half-width",
    default: Value::Number(0.5),
    help: "half the light's side in metres, from 0 (no light) to 2",
    variants: &[0.3, 0.4, 0.6, 0.7, 0.75, 0.9],
    letter: Some(Letter {
        names: &["s"],
        value: |values| room(values).map(|scene| scene.light_half_width),
        generic: 0.83,
    }),
};
const POINT: Parameter = Parameter {
    name: "point",
    default: Value::Point([0.0, 0.0, 1.0]),
    help: "the point p on a face of the cube or the room, in metres",
    variants: &[],
    letter: None,
};

pub(crate) const QUESTIONS: &[Question] = &[
    Question {
        id: "4.1",
        title: "Paths of two bounces",
        statement: "The cube stands in a room; all faces are diffuse, and a light hangs in the ceiling. Draw \
                    several paths of two bounces that end at p, on the cube's top, and go on to the eye. \
                    Label ω_o, ω_i, p and the point p_j of the room that each of them meets first.",
        hint: "Draw backwards, as a path tracer does: from p in a random direction ω_i to the point p_j that \
               it meets, and from there to the light. A bounce is a vertex between light and eye.",
        formula: "light → p_j → p → eye: two bounces, at p_j and at p, for every ω_i above the surface",
        latex: &[r"\text{light} \to \mathbf p_j \to \mathbf p \xrightarrow{\;\omega_o\;} \text{eye},
              \qquad \omega_{i,j} = \frac{\mathbf p_j - \mathbf p}{\lVert \mathbf p_j - \mathbf p\rVert}"],
        answer: "From p the direction ω_i is drawn at random, uniformly or in proportion to cos θ, and a ray \
                 is followed to p_j; from there the light is sampled. ω_i points away from p, towards where \
                 the light comes from. From the cube's top only the walls above it and the ceiling are \
                 visible; the ceiling lies in the light's plane and receives no light, so two-bounce light \
                 comes by way of the walls.",
        numbers: &[],
        wrong: &[
            Wrong {
                answer: "ω_o is ω_i mirrored",
                slip: "a diffuse surface has no preferred direction: any ω_i above it will do",
            },
            Wrong {
                answer: "a segment through the cube",
                slip: "light does not pass through wood: the path ends where it first meets a face",
            },
            Wrong { answer: "ω_i below the horizon of p", slip: "no light reaches p from inside the cube" },
            Wrong {
                answer: "ω_i points into p",
                slip: "by convention both ω_i and ω_o point away from the surface",
            },
        ],
        on_the_original: Some(
            "The room, its light and its measures are this workbook's: 4 m wide, 4 m deep, 4 m high, a cube \
             of 1 m on the floor, a square light of «2s» m in the middle of the ceiling.",
        ),
        example: "q4_1_two_bounces",
        lines: 0,
        parameters: &[WALL_ALBEDO, CUBE_ALBEDO, RADIANCE, LIGHT_HALF_WIDTH, POINT],
        derived: &[],
    },
    Question {
        id: "4.2",
        title: "Paths of three bounces",
        statement: "Draw several paths of three bounces that end at p. Label ω_o, and the points p_j and \
                    p_j′ on the way.",
        hint: "One more vertex: from p_j another random direction, above the face that p_j lies on, leads to \
               p_j′.",
        formula: "light → p_j′ → p_j → p → eye: three bounces, at p_j′, p_j and p",
        latex: &[r"\text{light} \to \mathbf p_j' \to \mathbf p_j \to \mathbf p \xrightarrow{\;\omega_o\;}
              \text{eye}"],
        answer: "Every vertex draws its next direction around its own normal. A path of three bounces sees \
                 more of the room than one of two: floor, ceiling and the cube's sides are reached now. Each \
                 bounce multiplies the radiance by the albedo of the face, «ρ_wall» on a wall, so more \
                 bounces contribute less, but never 0.",
        numbers: &[],
        wrong: &[
            Wrong { answer: "p_j′ on the same wall as p_j", slip: "a flat face does not see itself" },
            Wrong {
                answer: "directions around the normal of p at p_j",
                slip: "each face has its own horizon",
            },
            Wrong {
                answer: "three segments",
                slip: "three bounces are three vertices, and four segments with the one to the eye",
            },
        ],
        on_the_original: None,
        example: "q4_2_three_bounces",
        lines: 0,
        parameters: &[WALL_ALBEDO, CUBE_ALBEDO, RADIANCE, LIGHT_HALF_WIDTH, POINT],
        derived: &[],
    },
    Question {
        id: "4.3",
        title: "The estimator for paths",
        statement: "n paths of two bounces are followed from the eye to p, to p_j in directions ω_ij drawn \
                    from p(ω), and to the light. Express the Monte Carlo estimator of the outgoing radiance \
                    at p in terms of the radiance L_o that leaves p_j.",
        hint: "It is the estimator of 3.4. From which point does the radiance come that arrives at p from \
               ω_ij, and in which direction does it leave that point?",
        formula: "L̂_o(p, ω_o) = 1/n Σ (ρ/π) L_o(p_j, −ω_ij) cos θ_ij / p(ω_ij), n counting all directions",
        latex: &[r"\hat L_o(\mathbf p, \omega_o)
              = \frac1n \sum_{j=1}^n \frac{f_r\, L_o(\mathbf p_j, -\omega_{i,j})
              \cos\theta_{i,j}}{p(\omega_{i,j})}
              = \frac1n \sum_{j=1}^n \frac{\frac{\rho}{\pi}\, L_o(\mathbf p_j, -\omega_{i,j})
              \cos\theta_{i,j}}{p(\omega_{i,j})}"],
        answer: "Radiance does not change along a ray: what arrives at p from ω_ij is what left p_j towards \
                 p, L_i(p, ω_ij) = L_o(p_j, −ω_ij). If L_o(p_j) is the radiance that p_j reflects directly \
                 from the light, this is the two-bounce part; an unbiased estimate of it in its place, with \
                 random numbers of its own, does not change the mean, because the mean of a product of \
                 independent factors is the product of their means. So the radiance at p_j may be estimated \
                 by way of a further point p_j′, and so on: that is path tracing, and Russian roulette (5) \
                 ends it. In this room the radiance after one bounce, 8F with F the form factor of two \
                 parallel squares, and after two, an integral over the walls, are known exactly.",
        numbers: &[],
        wrong: &[
            Wrong {
                answer: "1/n′, n′ the directions that are not occluded",
                slip: "an occluded direction is a sample, too: it adds 0. With light only at cos θ > ½ and \
                       uniform directions this doubles the answer",
            },
            Wrong {
                answer: "cos θ_ij forgotten",
                slip: "it accounts for the tilt of p's face, and cancels against p(ω) only for \
                       cosine-distributed directions",
            },
            Wrong {
                answer: "L_o(p_j, ω_ij)",
                slip: "light leaves p_j towards p: against the direction that was drawn",
            },
            Wrong {
                answer: "all light at p",
                slip: "this is the two-bounce part only; light that arrives directly is another part",
            },
        ],
        on_the_original: Some(
            "The original's sum is an estimate, so L_o needs a hat; p is evaluated at each ω_ij; and n must \
             count all directions, not those of non-occluded paths alone. It is the two-bounce part of the \
             radiance, not all of it.",
        ),
        example: "q4_3_paths",
        lines: 4,
        parameters: &[
            WALL_ALBEDO,
            CUBE_ALBEDO,
            RADIANCE,
            LIGHT_HALF_WIDTH,
            Parameter {
                name: "bounces",
                default: Value::Limit(Some(2)),
                help: "the number of bounces K, from 0 to 64, or all",
                variants: &[],
                letter: None,
            },
            POINT,
        ],
        derived: &[],
    },
];
