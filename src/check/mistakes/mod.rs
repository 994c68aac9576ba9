//! The gallery of classic mistakes, and the probes that tell them apart.
//!
//! A [`Topic`] is a kind of estimator; its [`Probe`]s are problems of known truth for it. Each [`Mistake`] comes with the wrong estimator itself
//! and with what its draws average to on any probe, in closed form or by quadrature. One's own estimator is an [`Attempt`].

mod attempt;
mod by_hand;
mod exponential;
mod furnace;
mod hemisphere;
mod mistake;
mod paths;
mod probe;
mod rectangle;
mod roulette;
mod topic;

pub use attempt::Attempt;
pub use by_hand::{HandAnswer, Judgement, Slip, answers, judge_answer};
pub use exponential::Statistic;
pub use hemisphere::Sky;
pub use mistake::Mistake;
pub use probe::Probe;
pub use rectangle::Surface;
pub use topic::Topic;

use mistake::{Words, words};
use probe::Setup;
