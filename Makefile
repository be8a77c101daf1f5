# Verbund. `make help` lists what there is.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
MAKEFLAGS += --no-print-directory

CARGO ?= cargo
PROGRAMS := --bin platform --bin factory-connector --bin script-quickjs --bin script-deno --bin simulator --bin demo
# Delivered programs of the workspace; tools/supply-chain/programs.js lists the same.
DELIVERED := --package platform --package factory-connector --package script-quickjs --package script-deno --package asi-cli --package simulator
CARGO_DENY := 0.20.2
CARGO_DENY_INSTALLED := target/tools/.cargo-deny-$(CARGO_DENY)
SCRIPT_DENO := $(CURDIR)/mapping-engine/script-deno/node_modules/@deno/linux-$(if $(filter aarch64,$(shell uname -m)),arm64,x64)-glibc/deno
WEB_SOURCES := $(shell find web -type f -not -path '*/node_modules/*' -not -path '*/dist/*' 2>/dev/null)

help: ## this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  make \1\t\2/' | expand -t 22

demo: prerequisites web ## two factories, a cloud and an order on this machine, until Ctrl-C; a second start goes on
	$(CARGO) build --locked $(PROGRAMS)
	target/debug/demo run

demo-check: prerequisites-test foreign browser web ## the demo headless, each step checked from outside
	$(CARGO) build --locked $(PROGRAMS)
	target/debug/demo check

dev: prerequisites web ## build everything for development
	$(CARGO) build --workspace --all-targets

test: prerequisites-test foreign browser web ## everything that proves the product right (what CI runs)
	# The checks of the pages and of the supply chain take what the build and the tests leave over of the processors.
	mkdir -p target
	nice -n 5 $(MAKE) web-checks >target/web-checks.log 2>&1 & checks=$$!; \
	  nice -n 5 $(MAKE) supply-chain >target/supply-chain.log 2>&1 & supply=$$!; \
	  trap "kill $$checks $$supply 2>/dev/null || true" EXIT; \
	  $(MAKE) rust-checks rust-tests; \
	  wait $$checks && echo "The pages are in order." || { cat target/web-checks.log; exit 1; }; \
	  wait $$supply && echo "The supply chain is in order." && sed -n '/^NOT CHECKED/p' target/supply-chain.log || { cat target/supply-chain.log; exit 1; }

check: test ## as make test, under the name people look for

unit: ## fast tests: no broker, browser, foreign peer or Node.js; CRATE=mapping for one crate
	@# Library tests only: what starts other programs is an integration test. Without CRATE all crates are built with the
	@# features of the whole workspace, so that nothing is compiled again when `make test` follows.
	@if $(CARGO) nextest --version >/dev/null 2>&1; then \
	  $(CARGO) nextest run --locked --lib --no-fail-fast $(if $(CRATE),-p $(CRATE),--workspace); \
	else \
	  $(CARGO) test --locked --lib --no-fail-fast $(if $(CRATE),-p $(CRATE),--workspace); fi

programs: web ## the programs to deliver, release build, without what only the tests of others need; into target/release
	$(CARGO) build --locked --release $(DELIVERED)

supply-chain: sbom $(CARGO_DENY_INSTALLED) ## licences, sources, banned crates, advisories, notices and bills of materials of what we build on
	manifests=$$(node tools/supply-chain/advisories.js --manifests); for manifest in $$manifests; do \
	  target/tools/bin/cargo-deny --locked --manifest-path $$manifest --config deny.toml check bans licenses sources; done
	node --test tools/supply-chain/
	node tools/supply-chain/advisories.js --report

advisories: $(CARGO_DENY_INSTALLED) ## known weaknesses of crates and npm packages, and what the lists said into asked.json; fails where they cannot be had: ADVISORY_DB=clone
	node tools/supply-chain/advisories.js

sbom: web tools/supply-chain/node_modules/.installed ## a bill of materials (CycloneDX) of each program, into target/sbom
	node tools/supply-chain/sbom.js

notices: web ## writes THIRD-PARTY-NOTICES.txt after a change of dependencies
	node tools/supply-chain/notices.js

$(CARGO_DENY_INSTALLED):
	CARGO_TARGET_DIR=target/tools/build $(CARGO) install --quiet --debug --locked --root target/tools cargo-deny --version $(CARGO_DENY)
	rm -rf target/tools/build
	touch $@

tools/supply-chain/node_modules/.installed: tools/supply-chain/package-lock.json
	cd tools/supply-chain && npm ci --no-audit --no-fund --loglevel=error
	touch $@

lint: web-checks rust-checks ## format, clippy, documentation, and the same for the web pages

rust-checks: web
	$(CARGO) fmt --check
	$(CARGO) clippy --locked --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --locked --workspace --no-deps --document-private-items --quiet

rust-tests: web deno
	$(CARGO) build --locked --workspace --bins --tests
	# Patched crates are no members of the workspace: their tests have dependencies of their own.
	$(CARGO) test --quiet --locked --manifest-path vendor/Cargo.toml --target-dir target/vendor --workspace --lib --tests \
	  --features async-opcua-crypto/legacy-crypto,async-opcua-types/json,async-opcua-types/xml,fe2o3-amqp/acceptor,serde_amqp/derive
	# Much of what tests do is waiting for other programs: one more at a time than there are processors.
	# What plants do with scripts is played again with the second engine. What must not compile beside the gate stands in its
	# documentation, which nextest does not play.
	if $(CARGO) nextest --version >/dev/null 2>&1; then \
	  run="$(CARGO) nextest run --locked --workspace --no-fail-fast --test-threads $$(($$(nproc) + 1))"; \
	  $$run && SCRIPT_DENO=$(SCRIPT_DENO) $$run -E 'package(factory-connector) & test(/^mappings::/)' && \
	  $(CARGO) test --locked -p disclosure -p mapping-engine -p connector-state -p factory-connector -p platform --doc; \
	else \
	  $(CARGO) test --locked --workspace --no-fail-fast && \
	  SCRIPT_DENO=$(SCRIPT_DENO) $(CARGO) test --locked -p factory-connector --test it -- mappings::; fi

web-checks: web
	$(MAKE) -j3 --output-sync=target web-lint web-check web-test

web-lint web-check web-test: web
	cd web && npm run --silent $(@:web-%=%)

bench: prerequisites-test foreign web deno ## latency and throughput of the whole path and of both script engines, release build; writes target/bench/results.json
	$(CARGO) build --locked --release $(PROGRAMS) --bin bench --bin asi
	$(CARGO) run --locked --release --quiet -p mapping-engine --example mapping_rate
	target/release/bench

chaos: prerequisites-test web ## kills, cuts, lost stores, clocks, full disks: MINUTES=30 SEED=n BROKER=rabbitmq; fails below KILLS=n or FAULTS=n; proves nothing lost or doubled
	$(CARGO) build --locked $(PROGRAMS) --bin chaos
	target/debug/chaos --minutes $(or $(MINUTES),5) $(if $(SEED),--seed $(SEED)) $(if $(KILLS),--at-least-kills $(KILLS)) $(if $(FAULTS),--at-least-faults $(FAULTS)) $(if $(BROKER),--broker $(BROKER))

mutants: prerequisites-test web ## breaks one guarantee of delivery after the other; chaos has to find each: MINUTES=5 SEED=7
	tests/mutants/run.sh $(or $(MINUTES),5) $(or $(SEED),7)

mutants-gate: ## breaks one rule of the disclosure gate after the other; its tests have to find each: NAMES="..."
mutants-ledger: ## weakens the verification of the ledger in one place after the other; its tests have to find each: NAMES="..."
mutants-platform: ## brings one attack on the platform back after the other; its tests have to find each: NAMES="..."
mutants-edges: ## opens one way in that the security review found after the other; the test of each has to fail: NAMES="..."
mutants-gate mutants-ledger mutants-platform mutants-edges:
	tests/mutants/play.sh $(@:mutants-%=%) $(NAMES)

knowledge: ## 1 000 histories of whole connectors: partners learn nothing below the policies: CASES=1000 SEED=n
	VERBUND_KNOWLEDGE_CASES=$(or $(CASES),1000) $(if $(SEED),VERBUND_KNOWLEDGE_SEED=$(SEED)) \
	  $(CARGO) test --locked -p factory-connector --lib coordinator::tests::knowledge -- --nocapture

probes: prerequisites-test web ## attacks that once worked, against release builds: answer, time and memory of each, and many at once: ONLY="name"
	$(CARGO) build --locked --release $(PROGRAMS) --bin probes
	target/release/probes $(if $(ONLY),"$(ONLY)")

fuzz: ## random input for every edge, shared by its targets: HOURS=1, or SECONDS=60 for each; TARGETS="..."; RECORD=1 writes docs/fuzzing.md
	tools/fuzz.sh $(or $(SECONDS),$(if $(HOURS),$(HOURS)h,60)) $(TARGETS)

test-slow: ## what takes too long for each change: histories, foreign peers, fuzzing, scale, every page, chaos, mutants of delivery, gate, ledger, platform and edges
	$(MAKE) knowledge
	$(MAKE) foreign-kills
	$(MAKE) foreign-rest MINUTES=10
	$(MAKE) fuzz
	$(MAKE) scale
	$(MAKE) probes
	$(MAKE) screenshots
	$(MAKE) chaos MINUTES=$(or $(MINUTES),30)
	$(MAKE) mutants MINUTES=$(or $(MUTANT_MINUTES),2)
	$(MAKE) mutants-gate
	$(MAKE) mutants-ledger
	$(MAKE) mutants-platform
	$(MAKE) mutants-edges

deno: mapping-engine/script-deno/node_modules/.installed ## the Deno executable of the second script engine, from npm

mapping-engine/script-deno/node_modules/.installed: mapping-engine/script-deno/package-lock.json
	# The executable is a package by itself: nothing is to be run for it.
	cd mapping-engine/script-deno && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error
	touch $@

asi-foreign: foreign ## what the shared language writes, read by other stacks alone; make test has it, too
	tests/foreign/asi/run.sh

foreign-kills: foreign ## three foreign servers with the limits of small controllers, killed, frozen and moved KILLS=100 times, everything live again within 5 s each time: SEED=n
	FOREIGN_KILLS=$(or $(KILLS),100) $(if $(SEED),FOREIGN_SEED=$(SEED)) \
	  $(CARGO) test --locked -p shop-floor --test it -- through_kills_freezes_and_moves --nocapture

foreign-rest: foreign ## the same servers left at rest for MINUTES=10 beside a counter every 100 ms: no reconnect, nothing lost
	FOREIGN_REST_MINUTES=$(or $(MINUTES),10) $(CARGO) test --locked -p shop-floor --test it -- is_left_in_peace

screenshots: demo-programs ## looks for barriers, then every page in light and dark, German and English, into target/screenshots
	target/debug/demo screenshots

scale: demo-programs ## 2 000 requests, 20 000 fields, a source of 100 000 nodes: first paint and answers of every page
	target/debug/demo newcomer --with-very-much

demo-programs: prerequisites-test browser web
	$(CARGO) build --locked $(PROGRAMS)

web: web/dist/.built

web/node_modules/.installed: web/package-lock.json
	cd web && npm ci --no-audit --no-fund --loglevel=error
	touch $@

web/dist/.built: web/node_modules/.installed $(WEB_SOURCES)
	cd web && npm run --silent build
	touch $@

browser: tests/browser/node_modules/.installed

tests/browser/node_modules/.installed: tests/browser/package-lock.json
	cd tests/browser && npm ci --no-audit --no-fund --loglevel=error
	touch $@

foreign:
	@tests/foreign/setup.sh

prerequisites:
	@tools/prerequisites.sh demo

prerequisites-test:
	@tools/prerequisites.sh test

.PHONY: probes supply-chain advisories sbom notices programs fuzz test-slow knowledge mutants-gate mutants-ledger mutants-platform mutants-edges foreign-kills foreign-rest rust-checks rust-tests web-checks web-lint web-check web-test asi-foreign browser chaos help demo demo-check demo-programs dev test unit check lint bench mutants scale screenshots deno web foreign prerequisites prerequisites-test
