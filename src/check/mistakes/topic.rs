//! The kinds of estimators.

use std::fmt;
use std::sync::LazyLock;

use super::{Mistake, Probe, exponential, furnace, hemisphere, paths, rectangle, roulette};

/// A kind of estimator, with its probes and its classic mistakes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Topic {
    /// Sampling the exponential distribution (worksheet 1.1, 1.2).
    Exponential,
    /// An integral over a rectangle (2.1).
    Rectangle,
    /// Light reflected by a diffuse surface (3.2, 3.4, 3.5).
    Hemisphere,
    /// Russian roulette around another estimator (5).
    Roulette,
    /// The number of bounces that roulette allows (5.1 to 5.3).
    Bounces,
    /// Light after several bounces where every face emits and reflects alike.
    Furnace,
    /// Light along paths in the box room (4.3).
    Paths,
}

impl Topic {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Exponential,
        Self::Rectangle,
        Self::Hemisphere,
        Self::Roulette,
        Self::Bounces,
        Self::Furnace,
        Self::Paths,
    ];

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exponential => "exponential samples",
            Self::Rectangle => "integral over a rectangle",
            Self::Hemisphere => "reflected light",
            Self::Roulette => "Russian roulette",
            Self::Bounces => "number of bounces",
            Self::Furnace => "light in a furnace",
            Self::Paths => "paths in the box room",
        }
    }

    /// The topic of a worksheet question ("3.5"), if that question asks for an estimator.
    ///
    /// ```
    /// use unbiased::check::Topic;
    ///
    /// assert_eq!(Topic::of_question("3.5"), Some(Topic::Hemisphere));
    /// assert_eq!(Topic::of_question("1.3"), None);
    /// ```
    pub fn of_question(question: &str) -> Option<Self> {
        match question {
            "1.1" | "1.2" => Some(Self::Exponential),
            "2.1" => Some(Self::Rectangle),
            "3.2" | "3.4" | "3.5" => Some(Self::Hemisphere),
            "4.3" => Some(Self::Paths),
            "5" => Some(Self::Roulette),
            "5.1" | "5.1(iii)" | "5.2" => Some(Self::Bounces),
            _ => None,
        }
    }

    /// Its probes. No parameter that hides a mistake (λ = 1, p = ½, a square, L = 1) stands alone.
    pub fn probes(self) -> &'static [Probe] {
        static PROBES: LazyLock<[Vec<Probe>; 7]> = LazyLock::new(|| {
            [
                exponential::probes(),
                rectangle::probes(),
                hemisphere::probes(),
                roulette::wrapper_probes(),
                roulette::bounce_probes(),
                furnace::probes(),
                paths::probes(),
            ]
        });
        PROBES.get(self as usize).map_or(&[], Vec::as_slice)
    }

    /// Its classic mistakes.
    pub fn mistakes(self) -> &'static [Mistake] {
        static MISTAKES: LazyLock<[Vec<Mistake>; 7]> = LazyLock::new(|| {
            [
                exponential::mistakes(),
                rectangle::mistakes(),
                hemisphere::mistakes(),
                roulette::wrapper_mistakes(),
                roulette::bounce_mistakes(),
                furnace::mistakes(),
                paths::mistakes(),
            ]
        });
        MISTAKES.get(self as usize).map_or(&[], Vec::as_slice)
    }
}

impl fmt::Display for Topic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
