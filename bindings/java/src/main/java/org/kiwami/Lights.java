// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import java.nio.ByteBuffer;

/** Lights in direct memory: points of power 1, until they are set otherwise. */
public final class Lights {
  /** The kinds of lights; light.h says which fields each has. */
  public enum Kind {
    POINT,
    SPOT,
    TRIANGLE,
    QUAD,
    SPHERE,
    DISC,
    DISTANT,
    ENVIRONMENT
  }

  final ByteBuffer buffer;
  private final int count;

  public Lights(int count) {
    this.count = count;
    buffer = Rays.direct((long) count * Native.Light.STRUCT_BYTES);
    for (int i = 0; i < count; ++i) {
      setPower(i, 1);
      setLinkMask(i, -1);
    }
  }

  public int count() {
    return count;
  }

  /** The memory: 96 bytes a light, as kiwami_light of light.h. */
  public ByteBuffer buffer() {
    return buffer;
  }

  private int at(int light, int field) {
    return light * Native.Light.STRUCT_BYTES + field;
  }

  private void setVector(int at, float x, float y, float z) {
    buffer.putFloat(at, x);
    buffer.putFloat(at + 4, y);
    buffer.putFloat(at + 8, z);
  }

  public void setKind(int light, Kind kind) {
    buffer.putInt(at(light, Native.Light.TYPE), kind.ordinal());
  }

  /** Of triangles, quads and discs: whether they shine to both sides. */
  public void setTwoSided(int light, boolean isTwoSided) {
    int flags = isTwoSided ? Native.KIWAMI_LIGHT_TWO_SIDED : 0;
    buffer.putInt(at(light, Native.Light.FLAGS), flags);
  }

  /** Sets one of the four points. */
  public void setPoint(int light, int point, float x, float y, float z) {
    setVector(at(light, Native.Light.POINTS) + 12 * point, x, y, z);
  }

  public void setDirection(int light, float x, float y, float z) {
    setVector(at(light, Native.Light.DIRECTION), x, y, z);
  }

  public void setRadius(int light, float radius) {
    buffer.putFloat(at(light, Native.Light.RADIUS), radius);
  }

  /** The cosines of the angles of a spot, or of distant light. */
  public void setCone(int light, float cosInner, float cosOuter) {
    buffer.putFloat(at(light, Native.Light.COS_INNER), cosInner);
    buffer.putFloat(at(light, Native.Light.COS_OUTER), cosOuter);
  }

  /** What it emits in all: only ratios count. */
  public void setPower(int light, float power) {
    buffer.putFloat(at(light, Native.Light.POWER), power);
  }

  /** The caller's own number; copied to the choices. */
  public void setUserId(int light, int userId) {
    buffer.putInt(at(light, Native.Light.USER_ID), userId);
  }

  /** Lights a receiver only if (linkMask & the receiver's) != 0. */
  public void setLinkMask(int light, long linkMask) {
    buffer.putLong(at(light, Native.Light.LINK_MASK), linkMask);
  }
}
