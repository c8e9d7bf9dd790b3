# SPDX-License-Identifier: Apache-2.0
# What the filters in the documents share: numbers as text, and rows grouped in the order in which they come.

# A number with so many decimals. What is not known is a dash.
def n(digits):
  if . == null then "-" else
    (. * pow(10; digits) | round) as $whole
    | ($whole | fabs | tostring) as $text
    | (if ($text | length) <= digits then ("0" * (digits + 1 - ($text | length))) + $text else $text end) as $padded
    | (if $whole < 0 then "-" else "" end) + $padded[:($padded | length) - digits]
      + (if digits > 0 then "." + $padded[-digits:] else "" end)
  end;

# With two digits that count, as far as two decimals go: 0.05, 1.4, 15, 162.
def short: if . == null then n(0) elif fabs < 0.995 then n(2) elif fabs < 9.95 then n(1) else n(0) end;

# With its sign: +1.5.
def signed(digits): if . != null and . >= 0 then "+" + n(digits) else n(digits) end;

# Rows that agree in f, as arrays.
def groups(f):
  reduce .[] as $row ([]; ($row | f) as $key
    | (map(.[0] | f) | index([$key])) as $at
    | if $at == null then . + [[$row]] else .[$at] += [$row] end);
