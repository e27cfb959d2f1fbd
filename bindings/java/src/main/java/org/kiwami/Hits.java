// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import java.nio.ByteBuffer;

/** Answers to rays in direct memory, which the library writes where they lie. */
public final class Hits {
  /** The number that names nothing. */
  public static final int INVALID_ID = Native.KIWAMI_INVALID_ID;

  final ByteBuffer buffer;
  private final int count;

  public Hits(int count) {
    this.count = count;
    buffer = Rays.direct((long) count * Native.Hit.STRUCT_BYTES);
  }

  public int count() {
    return count;
  }

  /** The memory: 36 bytes a hit, as kiwami_hit of trace.h. */
  public ByteBuffer buffer() {
    return buffer;
  }

  private float number(int hit, int field) {
    return buffer.getFloat(hit * Native.Hit.STRUCT_BYTES + field);
  }

  private int id(int hit, int field) {
    return buffer.getInt(hit * Native.Hit.STRUCT_BYTES + field);
  }

  /** Distance in units of the direction's length; infinite for a miss. */
  public float t(int hit) {
    return number(hit, Native.Hit.T);
  }

  /** The point is (1 - u - v) a + u b + v c. */
  public float u(int hit) {
    return number(hit, Native.Hit.U);
  }

  public float v(int hit) {
    return number(hit, Native.Hit.V);
  }

  /** (b - a) x (c - a), not normalised. */
  public float[] normal(int hit) {
    return new float[] {
      number(hit, Native.Hit.NORMAL_X), number(hit, Native.Hit.NORMAL_Y),
      number(hit, Native.Hit.NORMAL_Z)
    };
  }

  public int primitiveId(int hit) {
    return id(hit, Native.Hit.PRIMITIVE_ID);
  }

  public int geometryId(int hit) {
    return id(hit, Native.Hit.GEOMETRY_ID);
  }

  public int instanceId(int hit) {
    return id(hit, Native.Hit.INSTANCE_ID);
  }

  public boolean isHit(int hit) {
    return primitiveId(hit) != INVALID_ID;
  }
}
