// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import java.nio.ByteBuffer;
import java.nio.ByteOrder;

/** Rays in direct memory, which the library reads where they lie. */
public final class Rays {
  final ByteBuffer buffer;
  private final int count;

  /** Rays without end that meet meshes of all masks; origin and direction are to be set. */
  public Rays(int count) {
    this.count = count;
    buffer = direct((long) count * Native.Ray.STRUCT_BYTES);
    for (int i = 0; i < count; ++i) {
      setBounds(i, 0, Float.POSITIVE_INFINITY);
      setMask(i, -1);
    }
  }

  static ByteBuffer direct(long bytes) {
    return ByteBuffer.allocateDirect(Math.toIntExact(bytes)).order(ByteOrder.nativeOrder());
  }

  public int count() {
    return count;
  }

  /** The memory: 48 bytes a ray, as kiwami_ray of trace.h. */
  public ByteBuffer buffer() {
    return buffer;
  }

  private int at(int ray, int field) {
    return ray * Native.Ray.STRUCT_BYTES + field;
  }

  public void setOrigin(int ray, float x, float y, float z) {
    buffer.putFloat(at(ray, Native.Ray.ORIGIN_X), x);
    buffer.putFloat(at(ray, Native.Ray.ORIGIN_Y), y);
    buffer.putFloat(at(ray, Native.Ray.ORIGIN_Z), z);
  }

  public void setDirection(int ray, float x, float y, float z) {
    buffer.putFloat(at(ray, Native.Ray.DIRECTION_X), x);
    buffer.putFloat(at(ray, Native.Ray.DIRECTION_Y), y);
    buffer.putFloat(at(ray, Native.Ray.DIRECTION_Z), z);
  }

  public void setBounds(int ray, float tmin, float tmax) {
    buffer.putFloat(at(ray, Native.Ray.TMIN), tmin);
    buffer.putFloat(at(ray, Native.Ray.TMAX), tmax);
  }

  public void setTime(int ray, float time) {
    buffer.putFloat(at(ray, Native.Ray.TIME), time);
  }

  public void setMask(int ray, int mask) {
    buffer.putInt(at(ray, Native.Ray.MASK), mask);
  }

  /** KIWAMI_RAY_*: 1 ignores back faces, 2 front faces. */
  public void setFlags(int ray, int flags) {
    buffer.putInt(at(ray, Native.Ray.FLAGS), flags);
  }
}
