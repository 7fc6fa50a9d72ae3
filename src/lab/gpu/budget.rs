//! Time that a benchmark may take in all.

use std::time::{Duration, Instant};

pub struct Budget {
    /// Nothing where it may take as long as it takes.
    end: Option<Instant>,
}

impl Budget {
    /// From now on.
    pub fn new(whole: Option<Duration>) -> Budget {
        // A century is as good as none.
        Budget { end: whole.and_then(|whole| Instant::now().checked_add(whole)) }
    }

    /// What is left, if it is bounded.
    pub fn left(&self) -> Option<Duration> {
        self.end.map(|end| end.saturating_duration_since(Instant::now()))
    }

    pub fn is_over(&self) -> bool {
        self.left().is_some_and(|left| left.is_zero())
    }

    /// Whether what is foreseen to take so long, s, leaves as much again for what comes after it.
    pub fn bears(&self, seconds: f64) -> bool {
        self.left().is_none_or(|left| 2.0 * seconds <= left.as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_what_is_left_is_spent_at_once() {
        let none = Budget::new(None);
        assert!(none.bears(1e9) && !none.is_over() && none.left().is_none());
        let hour = Budget::new(Some(Duration::from_secs(3600)));
        assert!(hour.bears(1700.0) && !hour.bears(1801.0) && !hour.is_over());
        let spent = Budget::new(Some(Duration::ZERO));
        assert!(spent.is_over() && !spent.bears(1e-9));
        assert!(!Budget::new(Some(Duration::MAX)).is_over());
    }
}
