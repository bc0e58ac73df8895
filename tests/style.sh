#!/bin/bash
# Checks the layout of every C file, or mends it with --fix.
# SPDX-License-Identifier: LGPL-2.1-or-later
cd "$(dirname "$0")/.." || exit 1

flags="--braces-on-if-line --case-brace-indentation0 --case-indentation2
  --braces-after-struct-decl-line --line-length80 --no-tabs --cuddle-else
  --dont-line-up-parentheses --continuation-indentation4 --honour-newlines
  --tab-size8 --indent-level2 --leave-preprocessor-space"
laid_out=$(mktemp) || exit 1
trap 'rm -f "$laid_out"' EXIT
files=0 status=0

while IFS= read -r file; do
  files=$((files + 1))
  # A ~/.indent.pro would change the outcome. Some lines settle in the second pass.
  # shellcheck disable=SC2086
  indent --ignore-profile $flags -st "$file" 2>/dev/null \
    | indent --ignore-profile $flags -st - >"$laid_out" 2>/dev/null
  cmp -s "$laid_out" "$file" && continue
  if [ "${1:-}" = --fix ]; then
    cat "$laid_out" >"$file"
  else
    diff -u --label "$file" --label "$file, laid out" "$file" "$laid_out" | head -20
    status=1
  fi
done < <(find -H gst elements examples tools tests -name '*.c' | sort)

[ "$status" -eq 0 ] || echo "Run tests/style.sh --fix."
# Without its semicolon indent takes such a macro for the head of what follows.
if grep -rnE '^G_DEFINE_(QUARK|AUTO)[A-Z_]* \([^()]*\)$' --include='*.c' gst elements tools tests; then
  echo "A semicolon is missing; a quark is a function of its own."
  status=1
fi
echo "$files files"
[ "$files" -gt 0 ] && exit $status
