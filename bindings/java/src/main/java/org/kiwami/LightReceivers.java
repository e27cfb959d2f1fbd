// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import java.nio.ByteBuffer;

/** Who asks for lights, in direct memory: points without a normal, until they are set otherwise. */
public final class LightReceivers {
  final ByteBuffer buffer;
  private final int count;

  public LightReceivers(int count) {
    this.count = count;
    buffer = Rays.direct((long) count * Native.LightReceiver.STRUCT_BYTES);
    for (int i = 0; i < count; ++i) {
      setLinkMask(i, -1);
    }
  }

  public int count() {
    return count;
  }

  /** The memory: 56 bytes a receiver, as kiwami_light_receiver of light.h. */
  public ByteBuffer buffer() {
    return buffer;
  }

  private int at(int receiver, int field) {
    return receiver * Native.LightReceiver.STRUCT_BYTES + field;
  }

  private void setVector(int at, float x, float y, float z) {
    buffer.putFloat(at, x);
    buffer.putFloat(at + 4, y);
    buffer.putFloat(at + 8, z);
  }

  public void setPosition(int receiver, float x, float y, float z) {
    setVector(at(receiver, Native.LightReceiver.POSITION), x, y, z);
  }

  public void setNormal(int receiver, float x, float y, float z) {
    setVector(at(receiver, Native.LightReceiver.NORMAL), x, y, z);
  }

  /** From the position to the other end of a segment. */
  public void setSegment(int receiver, float x, float y, float z) {
    setVector(at(receiver, Native.LightReceiver.SEGMENT), x, y, z);
  }

  /** Whether it takes light from both sides of its normal. */
  public void setBothSides(int receiver, boolean takesBothSides) {
    int flags = takesBothSides ? Native.KIWAMI_RECEIVER_BOTH_SIDES : 0;
    buffer.putInt(at(receiver, Native.LightReceiver.FLAGS), flags);
  }

  public void setLinkMask(int receiver, long linkMask) {
    buffer.putLong(at(receiver, Native.LightReceiver.LINK_MASK), linkMask);
  }

  /** At least 0, below 1. */
  public void setRandom(int receiver, double random) {
    buffer.putDouble(at(receiver, Native.LightReceiver.RANDOM), random);
  }
}
