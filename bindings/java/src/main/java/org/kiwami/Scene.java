// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import com.sun.jna.Memory;
import com.sun.jna.Pointer;
import java.lang.ref.Cleaner;
import java.lang.ref.Reference;
import java.nio.Buffer;
import java.nio.ByteBuffer;
import java.nio.charset.StandardCharsets;

/**
 * Meshes under one acceleration structure. Changes take effect with commit(). A committed scene can
 * be traced from any number of threads.
 */
public final class Scene implements AutoCloseable {
  private final Pointer device;
  private final Pointer object;
  private final Cleaner.Cleanable cleanable;
  private volatile boolean isClosed;

  public Scene(Device device) {
    this.device = device.object();
    Memory made = new Memory(com.sun.jna.Native.POINTER_SIZE);
    KiwamiException.check(Native.kiwami_scene_create(this.device, made), this.device);
    Reference.reachabilityFence(device);
    Native.kiwami_device_retain(this.device);
    object = made.getPointer(0);
    Pointer ownedScene = object;
    Pointer ownedDevice = this.device;
    cleanable =
        Device.CLEANER.register(
            this,
            () -> {
              Native.kiwami_scene_release(ownedScene);
              Native.kiwami_device_release(ownedDevice);
            });
  }

  private Scene(Pointer device, Pointer object) {
    this.device = device;
    this.object = object;
    Native.kiwami_device_retain(device);
    cleanable =
        Device.CLEANER.register(
            this,
            () -> {
              Native.kiwami_scene_release(object);
              Native.kiwami_device_release(device);
            });
  }

  private static Memory text(String value) {
    byte[] bytes = value.getBytes(StandardCharsets.UTF_8);
    Memory memory = new Memory(bytes.length + 1L);
    memory.write(0, bytes, 0, bytes.length);
    memory.setByte(bytes.length, (byte) 0);
    return memory;
  }

  /** Saves the committed scene; a file of that name stays whole until all is written. */
  public void save(String path) {
    Memory name = text(path);
    Memory desc = new Memory(Native.SaveDesc.STRUCT_BYTES);
    check(Native.kiwami_save_desc_init(desc, desc.size()));
    desc.setPointer(Native.SaveDesc.PATH, name);
    check(Native.kiwami_scene_save(object(), desc, null));
    Reference.reachabilityFence(name);
  }

  /** Loads a scene that save() wrote, by copy, checking every byte. */
  public static Scene load(Device device, String path) {
    return load(device, path, false, false);
  }

  /**
   * Loads a scene that save() wrote.
   *
   * @param map use the file where it lies; it may not change meanwhile
   * @param trusted check nothing: only for files that nobody else could change
   */
  public static Scene load(Device device, String path, boolean map, boolean trusted) {
    Memory name = text(path);
    Memory desc = new Memory(Native.LoadDesc.STRUCT_BYTES);
    KiwamiException.check(Native.kiwami_load_desc_init(desc, desc.size()), device.object());
    desc.setPointer(Native.LoadDesc.PATH, name);
    desc.setInt(
        Native.LoadDesc.FLAGS,
        (map ? Native.KIWAMI_LOAD_MAP : 0) | (trusted ? Native.KIWAMI_LOAD_TRUSTED : 0));
    Memory made = new Memory(com.sun.jna.Native.POINTER_SIZE);
    KiwamiException.check(
        Native.kiwami_scene_load(device.object(), desc, made), device.object());
    Reference.reachabilityFence(name);
    Scene scene = new Scene(device.object(), made.getPointer(0));
    Reference.reachabilityFence(device);
    return scene;
  }

  /** Lets go of the scene. Closing twice is allowed; no other thread may be tracing it. */
  @Override
  public void close() {
    isClosed = true;
    cleanable.clean();
  }

  private Pointer object() {
    if (isClosed) {
      throw new IllegalStateException("the scene is closed");
    }
    return object;
  }

  private void check(int result) {
    Reference.reachabilityFence(this);
    KiwamiException.check(result, device);
  }

  /** A direct buffer is read where it lies; an empty one has an address too. */
  private static Pointer address(Buffer buffer) {
    return buffer.capacity() == 0 ? new Memory(1) : com.sun.jna.Native.getDirectBufferPointer(buffer);
  }

  private static Memory copy(float[] values) {
    Memory memory = new Memory(Math.max(4L * values.length, 1));
    memory.write(0, values, 0, values.length);
    return memory;
  }

  private static Memory copy(int[] values) {
    Memory memory = new Memory(Math.max(4L * values.length, 1));
    memory.write(0, values, 0, values.length);
    return memory;
  }

  /** Adds a mesh that all rays meet. */
  public int addMesh(float[] vertices, int[] triangles) {
    return addMesh(vertices, triangles, -1);
  }

  /**
   * Adds a mesh, copied, and returns the number that hits report.
   *
   * @param vertices three numbers a vertex
   * @param triangles three numbers of vertices a triangle
   * @param mask only a ray with (ray's mask & mask) != 0 meets it
   */
  public int addMesh(float[] vertices, int[] triangles, int mask) {
    if (vertices.length % 3 != 0 || triangles.length % 3 != 0) {
      throw new IllegalArgumentException(
          "vertices has " + vertices.length + " and triangles " + triangles.length
              + " numbers, expected multiples of 3");
    }
    Memory positions = copy(vertices);
    Memory indices = copy(triangles);
    Memory desc = new Memory(Native.TriangleMeshDesc.STRUCT_BYTES);
    check(Native.kiwami_triangle_mesh_desc_init(desc, desc.size()));
    desc.setPointer(Native.TriangleMeshDesc.VERTICES, positions);
    desc.setLong(Native.TriangleMeshDesc.VERTEX_COUNT, vertices.length / 3);
    desc.setPointer(Native.TriangleMeshDesc.INDICES, indices);
    desc.setLong(Native.TriangleMeshDesc.TRIANGLE_COUNT, triangles.length / 3);
    desc.setInt(Native.TriangleMeshDesc.MASK, mask);
    Memory made = new Memory(com.sun.jna.Native.POINTER_SIZE);
    check(Native.kiwami_triangle_mesh_create(device, desc, made));
    Pointer geometry = made.getPointer(0);
    Memory number = new Memory(4);
    try {
      check(Native.kiwami_scene_attach(object(), geometry, number));
    } finally {
      Native.kiwami_geometry_release(geometry);
    }
    Reference.reachabilityFence(positions);
    Reference.reachabilityFence(indices);
    return number.getInt(0);
  }

  /** Removes a mesh; its number becomes free. */
  public void remove(int geometryId) {
    check(Native.kiwami_scene_detach(object(), geometryId));
  }

  /** Sets one of KIWAMI_PARAMETER_* of scene.h. */
  public void setParameter(int parameter, double value) {
    check(Native.kiwami_scene_set_parameter(object(), parameter, value));
  }

  /** Builds the acceleration structure of what the scene holds now. */
  public void commit() {
    check(Native.kiwami_scene_commit(object()));
  }

  /** The closest hit of each ray. */
  public Hits closestHit(Rays rays) {
    Hits hits = new Hits(rays.count());
    closestHit(rays, hits);
    return hits;
  }

  /** The same, into hits, of which there must be as many as rays. */
  public void closestHit(Rays rays, Hits hits) {
    if (hits.count() != rays.count()) {
      throw new IllegalArgumentException(
          "hits has room for " + hits.count() + ", expected " + rays.count());
    }
    check(
        Native.kiwami_closest_hit(
            object(), address(rays.buffer), 0, address(hits.buffer), 0, rays.count(), null));
  }

  /** Whether each ray has a hit. */
  public boolean[] anyHit(Rays rays) {
    ByteBuffer occluded = Rays.direct(rays.count());
    check(
        Native.kiwami_any_hit(
            object(), address(rays.buffer), 0, address(occluded), 0, rays.count(), null));
    boolean[] answers = new boolean[rays.count()];
    for (int i = 0; i < answers.length; ++i) {
      answers[i] = occluded.get(i) != 0;
    }
    return answers;
  }

  /** The nearest maxHits hits of each ray, by rising distance; 0 stands for all. */
  public MultiHits multiHit(Rays rays, int maxHits) {
    Memory offsets = new Memory(8L * (rays.count() + 1));
    Hits hits = new Hits(rays.count());
    for (;;) {
      int result =
          Native.kiwami_multi_hit(
              object(), address(rays.buffer), 0, rays.count(), maxHits, address(hits.buffer),
              hits.count(), offsets, null);
      if (result != Native.KIWAMI_ERROR_CAPACITY) {
        check(result);
        return new MultiHits(offsets.getLongArray(0, rays.count() + 1), hits);
      }
      hits = new Hits(Math.toIntExact(offsets.getLong(8L * rays.count())));
    }
  }

  /** How many hits each ray has. */
  public int[] countHits(Rays rays) {
    ByteBuffer counts = Rays.direct(4L * rays.count());
    check(
        Native.kiwami_count_hits(
            object(), address(rays.buffer), 0, address(counts), 0, rays.count(), null));
    int[] answers = new int[rays.count()];
    counts.asIntBuffer().get(answers);
    return answers;
  }
}
