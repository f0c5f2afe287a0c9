# The commands of the project; `.ci/run` runs what must hold before a change lands.

# Format, lint and document
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

# All tests
test:
    cargo test

# All benchmarks
bench:
    cargo bench -p radar-sim -p plot-extractor -p tracker

# What must hold before a change lands
ci:
    bash .ci/run
