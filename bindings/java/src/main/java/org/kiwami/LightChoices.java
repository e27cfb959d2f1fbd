// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import java.nio.ByteBuffer;

/** Lights that were chosen, in direct memory. */
public final class LightChoices {
  final ByteBuffer buffer;
  private final int count;

  LightChoices(int count) {
    this.count = count;
    buffer = Rays.direct((long) count * Native.LightChoice.STRUCT_BYTES);
  }

  public int count() {
    return count;
  }

  /** The memory: 24 bytes a choice, as kiwami_light_choice of light.h. */
  public ByteBuffer buffer() {
    return buffer;
  }

  private int at(int choice, int field) {
    return choice * Native.LightChoice.STRUCT_BYTES + field;
  }

  /** -1: none. */
  public int lightId(int choice) {
    return buffer.getInt(at(choice, Native.LightChoice.LIGHT_ID));
  }

  /** The instance through which the light is seen; -1: none. */
  public int instanceId(int choice) {
    return buffer.getInt(at(choice, Native.LightChoice.INSTANCE_ID));
  }

  public int userId(int choice) {
    return buffer.getInt(at(choice, Native.LightChoice.USER_ID));
  }

  /** With which this choice was made. */
  public float probability(int choice) {
    return buffer.getFloat(at(choice, Native.LightChoice.PROBABILITY));
  }

  /** A new random number, for a point on the light. */
  public double random(int choice) {
    return buffer.getDouble(at(choice, Native.LightChoice.RANDOM));
  }
}
