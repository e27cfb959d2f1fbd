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
  private final Geometries geometries;
  private final Cleaner.Cleanable cleanable;
  private volatile boolean isClosed;

  public Scene(Device device) {
    this(device.object(), create(device.object()));
    Reference.reachabilityFence(device);
  }

  private Scene(Pointer device, Pointer object) {
    this.device = device;
    this.object = object;
    geometries = new Geometries(device);
    Native.kiwami_device_retain(device);
    Geometries owned = geometries;
    cleanable =
        Device.CLEANER.register(
            this,
            () -> {
              owned.release();
              Native.kiwami_scene_release(object);
              Native.kiwami_device_release(device);
            });
  }

  private static Pointer create(Pointer device) {
    Memory made = new Memory(com.sun.jna.Native.POINTER_SIZE);
    KiwamiException.check(Native.kiwami_scene_create(device, made), device);
    return made.getPointer(0);
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

  /** The same; what the call was given as addresses is reachable until here. */
  private void check(int result, Object... given) {
    Reference.reachabilityFence(given);
    check(result);
  }

  /** A direct buffer is read where it lies; an empty one has an address too. */
  static Pointer address(Buffer buffer) {
    return buffer.capacity() == 0 ? new Memory(1) : com.sun.jna.Native.getDirectBufferPointer(buffer);
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
    int number = geometries.addMesh(object(), vertices, triangles, mask);
    Reference.reachabilityFence(this);
    return number;
  }

  /**
   * Adds a mesh whose vertices move, copied; returns its number as addMesh does, as all of these.
   *
   * @param vertices those of all steps, one step after the other
   * @param timeBegin when the mesh is where its first step says
   * @param timeEnd when the mesh is where its last step says
   */
  public int addMovingMesh(
      float[] vertices, int stepCount, int[] triangles, float timeBegin, float timeEnd, int mask) {
    int number =
        geometries.addMovingMesh(
            object(), vertices, stepCount, triangles, timeBegin, timeEnd, mask);
    Reference.reachabilityFence(this);
    return number;
  }

  /** Adds spheres: x, y, z and radius. */
  public int addSpheres(float[] points, int mask) {
    int number = geometries.addSpheres(object(), points, mask);
    Reference.reachabilityFence(this);
    return number;
  }

  /** Adds flat discs: x, y, z and radius, and a normal of three numbers each. */
  public int addDiscs(float[] points, float[] normals, int mask) {
    int number = geometries.addDiscs(object(), points, normals, mask);
    Reference.reachabilityFence(this);
    return number;
  }

  /** Adds round curve segments: segment i joins the points segments[i] and segments[i] + 1. */
  public int addCurves(float[] points, int[] segments, int mask) {
    int number = geometries.addCurves(object(), points, segments, mask);
    Reference.reachabilityFence(this);
    return number;
  }

  /** Adds instances of one scene, which all rays enter. */
  public int addInstances(Scene scene, float[] transforms) {
    return addInstances(new Scene[] {scene}, transforms, null, null, -1);
  }

  /**
   * Adds instances of these scenes. A commit shows what they have committed by then, and may not
   * overlap with theirs.
   *
   * @param transforms three rows of four numbers each, from the scene's space to this one's
   * @param sceneIndices which of the scenes each shows; null: the first
   * @param masks which rays enter each; null: all
   */
  public int addInstances(
      Scene[] scenes, float[] transforms, int[] sceneIndices, int[] masks, int mask) {
    Pointer[] shown = new Pointer[scenes.length];
    for (int i = 0; i < shown.length; ++i) {
      shown[i] = scenes[i].object();
    }
    int number =
        geometries.addInstances(object(), shown, transforms, sceneIndices, masks, mask);
    Reference.reachabilityFence(scenes);
    Reference.reachabilityFence(this);
    return number;
  }

  /** Gives a mesh other vertices, as many as it has; refit() or commit() shows them. */
  public void updateVertices(int geometryId, float[] vertices) {
    object();
    geometries.updateVertices(geometryId, vertices);
    Reference.reachabilityFence(this);
  }

  /** Leaves a geometry out, or takes it in again, under its number. */
  public void enable(int geometryId, boolean isEnabled) {
    check(Native.kiwami_scene_enable(object(), geometryId, isEnabled ? 1 : 0));
  }

  /** Removes a geometry; its number becomes free. */
  public void remove(int geometryId) {
    geometries.remove(object(), geometryId);
    Reference.reachabilityFence(this);
  }

  /** Sets one of KIWAMI_PARAMETER_* of scene.h. */
  public void setParameter(int parameter, double value) {
    check(Native.kiwami_scene_set_parameter(object(), parameter, value));
  }

  /** Builds the acceleration structure of what the scene holds now. */
  public void commit() {
    check(Native.kiwami_scene_commit(object()));
  }

  /**
   * As commit(), but keeps the tree where only vertices moved: quicker to make, and, the further
   * they moved, slower to trace.
   */
  public void refit() {
    check(Native.kiwami_scene_refit(object()));
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
            object(), address(rays.buffer), 0, address(hits.buffer), 0, rays.count(), null),
        rays,
        hits);
  }

  /** Whether each ray has a hit. */
  public boolean[] anyHit(Rays rays) {
    ByteBuffer occluded = Rays.direct(rays.count());
    check(
        Native.kiwami_any_hit(
            object(), address(rays.buffer), 0, address(occluded), 0, rays.count(), null),
        rays,
        occluded);
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
      Reference.reachabilityFence(rays);
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
            object(), address(rays.buffer), 0, address(counts), 0, rays.count(), null),
        rays,
        counts);
    int[] answers = new int[rays.count()];
    counts.asIntBuffer().get(answers);
    return answers;
  }
}
