// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

/** The instruction sets. */
public enum Isa {
  AUTO(Native.KIWAMI_ISA_AUTO),
  SCALAR(Native.KIWAMI_ISA_SCALAR),
  SSE(Native.KIWAMI_ISA_SSE),
  AVX2(Native.KIWAMI_ISA_AVX2),
  AVX512(Native.KIWAMI_ISA_AVX512);

  final int number;

  Isa(int number) {
    this.number = number;
  }
}
