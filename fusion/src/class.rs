//! What kind of target it is, from what several sources declare (F10).

/// Probabilities of the classes after declarations that are independent given the class:
/// p(c) ∝ Π_s P(declared_s | c), from equal priors. `likelihoods[s][c]` is what source s says of class c.
pub fn posterior<const CLASSES: usize>(likelihoods: impl IntoIterator<Item = [f64; CLASSES]>) -> [f64; CLASSES] {
    let mut log = [0.0; CLASSES];
    for of in likelihoods {
        for (sum, likelihood) in log.iter_mut().zip(of) {
            *sum += likelihood.max(f64::MIN_POSITIVE).ln();
        }
    }
    let most = log.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let odds = log.map(|value| (value - most).exp());
    let sum: f64 = odds.iter().sum();
    odds.map(|value| value / sum)
}

/// What a source that is right with probability `right`, and else declares any other class alike, says by declaring a class.
pub fn declared<const CLASSES: usize>(class: usize, right: f64) -> [f64; CLASSES] {
    let wrong = (1.0 - right) / (CLASSES as f64 - 1.0);
    std::array::from_fn(|of| if of == class { right } else { wrong })
}
