// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

/** The hits of many rays: those of ray i are hits offsets[i] to offsets[i + 1] - 1, by distance. */
public final class MultiHits {
  private final long[] offsets;
  private final Hits hits;

  MultiHits(long[] offsets, Hits hits) {
    this.offsets = offsets;
    this.hits = hits;
  }

  public long[] offsets() {
    return offsets.clone();
  }

  public Hits hits() {
    return hits;
  }

  /** How many hits a ray has. */
  public int count(int ray) {
    return (int) (offsets[ray + 1] - offsets[ray]);
  }
}
