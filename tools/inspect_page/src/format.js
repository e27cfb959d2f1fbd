// SPDX-License-Identifier: Apache-2.0
// Numbers as people read them.

const grouped = new Intl.NumberFormat('en', {maximumFractionDigits: 0});

export function count(number) {
  return grouped.format(number);
}

/** "1 node", "2,345 nodes". */
export function counted(number, noun) {
  return `${count(number)} ${noun}${number === 1 ? '' : 's'}`;
}

/** Four significant digits, without an exponent where that is short. */
export function measure(number) {
  if (number === 0) return '0';
  const size = Math.abs(number);
  if (size >= 1e6 || size < 1e-4) return number.toExponential(3).replace('e+', 'e');
  return String(Number(number.toPrecision(4)));
}

/** A share of 1 as a percentage of three significant digits. */
export function percent(share) {
  const value = share * 100;
  if (value === 0) return '0 %';
  if (value < 0.0001) return `${value.toExponential(1).replace('e+', 'e')} %`;
  return `${Number(value.toPrecision(3))} %`;
}

export function point(x, y, z) {
  return `${measure(x)}, ${measure(y)}, ${measure(z)}`;
}
