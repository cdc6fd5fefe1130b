#!/usr/bin/env bash
# Packages the extension as dist/blocksim.vsix. With `--test PROGRAM` the grammar, the package, and the client against that
# program are tested as well; with `--only-test PROGRAM` what was packaged before.
set -euo pipefail
program=
if [ "${1:-}" = "--test" ] || [ "${1:-}" = "--only-test" ]; then
    program=$(realpath "${2:?"usage: build.sh [--test PROGRAM | --only-test PROGRAM]"}")
fi
cd "$(dirname "$0")"
if [ "${1:-}" = "--only-test" ]; then
    BLOCKSIM="$program" npm test --silent
    exit
fi
# No scripts of packages are run: the bundler is a binary of its own, and the packager needs none.
npm ci --ignore-scripts --no-audit --no-fund --loglevel=error
npm run --silent build
node licences.mjs
npm run --silent package
if [ -n "$program" ]; then
    BLOCKSIM="$program" npm test --silent
fi
