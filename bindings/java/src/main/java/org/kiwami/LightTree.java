// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import com.sun.jna.Memory;
import com.sun.jna.Pointer;
import java.lang.ref.Cleaner;
import java.lang.ref.Reference;
import java.nio.ByteBuffer;

/**
 * Lights, among which points choose in proportion to what may reach them. Changes take effect with
 * commit() or refit(). A committed set can be sampled from any number of threads.
 */
public final class LightTree implements AutoCloseable {
  private final Pointer device;
  private final Pointer object;
  private final Cleaner.Cleanable cleanable;
  private volatile boolean isClosed;

  public LightTree(Device device) {
    this(device, 0);
  }

  /** width: children of a node: 2, 4, 8 or 16; 0: the device's default. */
  public LightTree(Device device, int width) {
    this.device = device.object();
    Memory desc = new Memory(Native.LightTreeDesc.STRUCT_BYTES);
    KiwamiException.check(Native.kiwami_light_tree_desc_init(desc, desc.size()), this.device);
    desc.setInt(Native.LightTreeDesc.WIDTH, width);
    Memory made = new Memory(com.sun.jna.Native.POINTER_SIZE);
    KiwamiException.check(Native.kiwami_light_tree_create(this.device, desc, made), this.device);
    Native.kiwami_device_retain(this.device);
    Reference.reachabilityFence(device);
    object = made.getPointer(0);
    Pointer ownedTree = object;
    Pointer ownedDevice = this.device;
    cleanable =
        Device.CLEANER.register(
            this,
            () -> {
              Native.kiwami_light_tree_release(ownedTree);
              Native.kiwami_device_release(ownedDevice);
            });
  }

  /** Lets go of the set. Closing twice is allowed; no other thread may be using it. */
  @Override
  public void close() {
    isClosed = true;
    cleanable.clean();
  }

  private Pointer object() {
    if (isClosed) {
      throw new IllegalStateException("the set of lights is closed");
    }
    return object;
  }

  private void check(int result) {
    Reference.reachabilityFence(this);
    KiwamiException.check(result, device);
  }

  /** The same; what the call was given as addresses is reachable until here. */
  private void check(int result, Object... given) {
    Reference.reachabilityFence(given);
    check(result);
  }

  /** Adds lights; returns the number of the first. */
  public int addLights(Lights lights) {
    Memory first = new Memory(4);
    check(
        Native.kiwami_light_tree_add_lights(
            object(), Scene.address(lights.buffer), 0, lights.count(), first),
        lights);
    return first.getInt(0);
  }

  /** Makes a light of radiance 1 of each triangle. */
  public int addMesh(float[] vertices, int[] triangles) {
    return addMesh(vertices, triangles, 1, false);
  }

  /** Makes a light of each triangle; returns the number of the first. */
  public int addMesh(float[] vertices, int[] triangles, float radiance, boolean isTwoSided) {
    Memory positions = Geometries.copy(vertices);
    Memory indices = Geometries.copy(triangles);
    Memory desc = new Memory(Native.LightMeshDesc.STRUCT_BYTES);
    check(Native.kiwami_light_mesh_desc_init(desc, desc.size()));
    desc.setInt(Native.LightMeshDesc.FLAGS, isTwoSided ? Native.KIWAMI_LIGHT_TWO_SIDED : 0);
    desc.setPointer(Native.LightMeshDesc.VERTICES, positions);
    desc.setLong(
        Native.LightMeshDesc.VERTEX_COUNT, Geometries.rows(vertices.length, 3, "vertices"));
    desc.setPointer(Native.LightMeshDesc.INDICES, indices);
    desc.setLong(
        Native.LightMeshDesc.TRIANGLE_COUNT, Geometries.rows(triangles.length, 3, "triangles"));
    desc.setFloat(Native.LightMeshDesc.RADIANCE, radiance);
    Memory first = new Memory(4);
    check(Native.kiwami_light_tree_add_mesh(object(), desc, first), positions, indices);
    return first.getInt(0);
  }

  /** Gives the lights from first on other powers. */
  public void setPowers(int first, float[] powers) {
    Memory values = Geometries.copy(powers);
    check(Native.kiwami_light_tree_set_powers(object(), first, values, 0, powers.length), values);
  }

  /** Builds the tree over all lights. */
  public void commit() {
    check(Native.kiwami_light_tree_commit(object()));
  }

  /** As commit(), but keeps the shape of the tree. */
  public void refit() {
    check(Native.kiwami_light_tree_refit(object()));
  }

  /** Lets each receiver choose a light. */
  public LightChoices sample(LightReceivers receivers) {
    LightChoices choices = new LightChoices(receivers.count());
    check(
        Native.kiwami_light_sample(
            object(), Scene.address(receivers.buffer), 0, Scene.address(choices.buffer), 0,
            receivers.count(), null),
        receivers);
    return choices;
  }

  /** The probability with which each receiver chooses the light of the choice beside it. */
  public float[] pdf(LightReceivers receivers, LightChoices choices) {
    if (choices.count() != receivers.count()) {
      throw new IllegalArgumentException(
          "there are " + choices.count() + " choices, expected " + receivers.count());
    }
    ByteBuffer probabilities = Rays.direct(4L * receivers.count());
    // A choice begins with the name of its light.
    check(
        Native.kiwami_light_pdf(
            object(), Scene.address(receivers.buffer), 0, Scene.address(choices.buffer),
            Native.LightChoice.STRUCT_BYTES, Scene.address(probabilities), 0, receivers.count(),
            null),
        receivers,
        choices);
    float[] answers = new float[receivers.count()];
    probabilities.asFloatBuffer().get(answers);
    return answers;
  }
}
