# The commands of the project; `.ci/run` runs what must hold before a change lands.

# Format, lint and document
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

# All tests
test:
    cargo test --workspace

# Property tests with other draws than `test` makes, and as many as asked for: `just search 7 50000`
search seed cases="20000":
    PROPTEST_RNG_SEED={{seed}} PROPTEST_CASES={{cases}} cargo test --release --workspace --no-fail-fast --lib --test any_input --test batch --test filter --test recording

# All benchmarks
bench:
    cargo bench -p radar-sim -p plot-extractor -p tracker -p recorder

# All results of docs/results/ again, tables and figures (half an hour)
results:
    cargo run --release -p experiments -- cfar --runs 1000 --figures docs/img
    cargo run --release -p experiments -- plot-accuracy --figures docs/img
    cargo run --release -p experiments -- initiation --figures docs/img --page docs/results/initiation.md
    cargo run --release -p experiments -- accuracy --figures docs/img --page docs/results/accuracy.md
    cargo run --release -p experiments -- accuracy --cells --page docs/results/accuracy.md
    cargo run --release -p experiments -- track-loss --runs 1000 --figures docs/img --page docs/results/track-loss.md
    cargo run --release -p experiments -- crossing --runs 1000 --figures docs/img --page docs/results/crossing.md
    cargo run --release -p experiments -- vsmm --figures docs/img --page docs/results/vsmm.md
    cargo run --release -p experiments -- multi-alternative --figures docs/img --page docs/results/multi-alternative.md
    cargo run --release -p experiments -- estimators --page docs/results/estimators.md
    cargo run --release -p experiments -- outliers --page docs/results/outliers.md
    cargo run --release -p experiments -- fusion --page docs/results/fusion.md

# The documents that are made from the program
docs:
    cargo build
    "${CARGO_TARGET_DIR:-target}/debug/radar-chain" config --docs > docs/configuration.md

# What must hold before a change lands
ci:
    bash .ci/run

lib := "/usr/local/lib"
sudo := if `id -u` == "0" { "" } else { "sudo" }

release := env("CARGO_TARGET_DIR", "target") / "release"
# What the manual needs beside the launcher
tools := "recorder tracker plot-extractor plot-source video-source outputs radar-link parquet-export experiments"

# Install the programs, completions and man pages, the units, their user and a first configuration (deploy/README.md)
install:
    cargo build --release --locked
    {{sudo}} install -Dm755 -t /usr/local/bin $(printf "{{release}}/%s " radar-chain {{tools}})
    {{release}}/radar-chain completions bash | {{sudo}} install -Dm644 /dev/stdin /usr/local/share/bash-completion/completions/radar-chain
    {{release}}/radar-chain completions zsh | {{sudo}} install -Dm644 /dev/stdin /usr/local/share/zsh/site-functions/_radar-chain
    {{release}}/radar-chain completions fish | {{sudo}} install -Dm644 /dev/stdin /usr/local/share/fish/vendor_completions.d/radar-chain.fish
    {{sudo}} {{release}}/radar-chain man /usr/local/share/man/man1
    {{sudo}} install -Dm644 -t {{lib}}/systemd/system deploy/systemd/radar-chain*.service deploy/systemd/radar-chain.target
    {{sudo}} install -Dm644 -t {{lib}}/systemd/system/radar-chain-.service.d deploy/systemd/radar-chain-.service.d/*.conf
    {{sudo}} install -Dm644 deploy/systemd/sysusers.conf {{lib}}/sysusers.d/radar-chain.conf
    test -e /etc/radar-chain/chain.toml || {{sudo}} install -Dm644 -t /etc/radar-chain deploy/chain.toml
    {{sudo}} systemd-sysusers {{lib}}/sysusers.d/radar-chain.conf
    {{sudo}} systemctl daemon-reload

# Stop the chain and remove what `install` has put there, but for configuration, recordings and user
uninstall:
    -{{sudo}} systemctl disable --now radar-chain.target radar-chain-plot-source.service radar-chain-video-source.service radar-chain-display.service radar-chain-link-in.service radar-chain-link-out.service
    {{sudo}} rm -rf {{lib}}/systemd/system/radar-chain*.service {{lib}}/systemd/system/radar-chain.target {{lib}}/systemd/system/radar-chain-.service.d
    {{sudo}} rm -f {{lib}}/sysusers.d/radar-chain.conf $(printf "/usr/local/bin/%s " radar-chain {{tools}})
    {{sudo}} rm -f /usr/local/share/bash-completion/completions/radar-chain /usr/local/share/zsh/site-functions/_radar-chain
    {{sudo}} rm -f /usr/local/share/fish/vendor_completions.d/radar-chain.fish /usr/local/share/man/man1/radar-chain.1 /usr/local/share/man/man1/radar-chain-*.1
    {{sudo}} systemctl daemon-reload

# Python layouts of the messages, from the Rust types
layouts:
    WRITE_LAYOUTS=1 cargo test --test python_layout

# The description of what the display answers, from the types
openapi:
    WRITE_OPENAPI=1 cargo test -p display --test openapi
