// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import static org.junit.Assert.assertArrayEquals;
import static org.junit.Assert.assertEquals;
import static org.junit.Assert.assertThrows;
import static org.junit.Assert.assertTrue;

import java.io.IOException;
import java.nio.charset.StandardCharsets;
import java.nio.file.Files;
import java.nio.file.Path;
import java.nio.file.Paths;
import java.nio.file.StandardOpenOption;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import java.util.Scanner;
import java.util.stream.IntStream;
import org.junit.Test;

/** The answers that every binding must give, to the bit. */
public class ConformanceTest {
  static String vectors(String name) throws IOException {
    Path path = Paths.get(System.getProperty("kiwami.vectors")).resolveSibling(name + ".txt");
    return new String(Files.readAllBytes(path), StandardCharsets.UTF_8);
  }

  /** Notes that features were found right, for the table of the documents. */
  static void note(String... features) throws IOException {
    String path = System.getenv("KIWAMI_FEATURES");
    if (path != null) {
      Files.write(
          Paths.get(path), List.of(features), StandardOpenOption.CREATE, StandardOpenOption.APPEND);
    }
  }

  static int word(Scanner words) {
    return (int) words.nextLong();
  }

  private static void assertHit(Scanner words, Hits hits, int hit) {
    for (int i = 0; i < Native.Hit.STRUCT_BYTES / 4; ++i) {
      assertEquals(word(words), hits.buffer().getInt(hit * Native.Hit.STRUCT_BYTES + 4 * i));
    }
  }

  private static void checkMultiHit(Scanner words, Scene scene, Rays rays) {
    int maxHits = word(words);
    long total = words.nextLong();
    MultiHits found = scene.multiHit(rays, maxHits);
    for (long offset : found.offsets()) {
      assertEquals(words.nextLong(), offset);
    }
    for (int i = 0; i < total; ++i) {
      assertHit(words, found.hits(), i);
    }
    int[] counts = scene.countHits(rays);
    for (int i = 0; i < counts.length; ++i) {
      assertEquals(maxHits == 0 ? counts[i] : Math.min(counts[i], maxHits), found.count(i));
    }
  }

  private static void checkFile(Scanner words, Device device, Scene scene, Rays rays)
      throws IOException {
    Path folder = Paths.get(System.getProperty("kiwami.vectors")).getParent();
    Path saved = Files.createTempFile("scene", ".kiwami");
    scene.save(saved.toString());
    byte[] expected = bytes(scene.closestHit(rays));
    for (Path path : new Path[] {saved, folder.resolve(words.next())}) {
      for (boolean map : new boolean[] {false, true}) {
        try (Scene loaded = Scene.load(device, path.toString(), map, map)) {
          assertArrayEquals(expected, bytes(loaded.closestHit(rays)));
        }
      }
    }
    Files.delete(saved);
    assertThrows(
        KiwamiException.class,
        () -> Scene.load(device, folder.resolve("vectors.txt").toString()));
    note("files");
  }

  static int[] words(Scanner words, int count) {
    return IntStream.range(0, count).map(i -> word(words)).toArray();
  }

  static float[] floats(Scanner words, int count) {
    float[] values = new float[count];
    for (int i = 0; i < count; ++i) {
      values[i] = Float.intBitsToFloat(word(words));
    }
    return values;
  }

  /** Adds a geometry of this kind, or says that it is none. */
  private static boolean addGeometry(
      String kind, Scanner words, Scene scene, Map<String, Scene> scenes) {
    int[] head;
    switch (kind) {
      case "mesh":
        head = words(words, 3);
        scene.addMesh(floats(words, 3 * head[1]), words(words, 3 * head[2]), head[0]);
        return true;
      case "moving_mesh":
        head = words(words, 6);
        scene.addMovingMesh(
            floats(words, 3 * head[1] * head[4]),
            head[1],
            words(words, 3 * head[5]),
            Float.intBitsToFloat(head[2]),
            Float.intBitsToFloat(head[3]),
            head[0]);
        return true;
      case "spheres":
        head = words(words, 2);
        scene.addSpheres(floats(words, 4 * head[1]), head[0]);
        return true;
      case "discs":
        head = words(words, 2);
        scene.addDiscs(floats(words, 4 * head[1]), floats(words, 3 * head[1]), head[0]);
        return true;
      case "curves":
        head = words(words, 3);
        scene.addCurves(floats(words, 4 * head[1]), words(words, head[2]), head[0]);
        return true;
      case "instances":
        addInstances(words, scene, scenes);
        return true;
      default:
        return false;
    }
  }

  private static void addInstances(Scanner words, Scene scene, Map<String, Scene> scenes) {
    int[] head = words(words, 3);
    Scene[] shown = new Scene[head[1]];
    for (int i = 0; i < shown.length; ++i) {
      shown[i] = scenes.get(words.next());
    }
    int[] indices = new int[head[2]];
    int[] masks = new int[head[2]];
    float[] transforms = new float[12 * head[2]];
    for (int i = 0; i < head[2]; ++i) {
      indices[i] = word(words);
      masks[i] = word(words);
      System.arraycopy(floats(words, 12), 0, transforms, 12 * i, 12);
    }
    scene.addInstances(shown, transforms, indices, masks, head[0]);
  }

  /** Changes the scene by one statement, or says that it does not change it. */
  private static boolean change(String statement, Scanner words, Scene scene) {
    int geometryId;
    switch (statement) {
      case "commit":
        scene.commit();
        return true;
      case "refit":
        scene.refit();
        return true;
      case "vertices":
        geometryId = word(words);
        scene.updateVertices(geometryId, floats(words, 3 * word(words)));
        return true;
      case "enable":
        geometryId = word(words);
        scene.enable(geometryId, word(words) != 0);
        return true;
      case "remove":
        scene.remove(word(words));
        return true;
      default:
        return false;
    }
  }

  private static void compare(
      String statement, Scanner words, Device device, Scene scene, Rays rays) throws IOException {
    switch (statement) {
      case "closest_hit":
        Hits hits = scene.closestHit(rays);
        for (int i = 0; i < rays.count(); ++i) {
          assertHit(words, hits, i);
        }
        break;
      case "any_hit":
        for (boolean occluded : scene.anyHit(rays)) {
          assertEquals(word(words) == 1, occluded);
        }
        break;
      case "multi_hit":
        checkMultiHit(words, scene, rays);
        break;
      case "file":
        checkFile(words, device, scene, rays);
        break;
      default:
        throw new AssertionError("the vectors have '" + statement + "'");
    }
  }

  /** Returns how many rays were compared. */
  private static int checkScene(Scanner words, Device device, Map<String, Scene> scenes)
      throws IOException {
    Scene scene = new Scene(device);
    scenes.put(words.next(), scene);
    Rays rays = new Rays(0);
    int compared = 0;
    for (String name = words.next(); !name.equals("end"); name = words.next()) {
      if (name.equals("rays")) {
        rays = new Rays(word(words));
        for (int i = 0; i < rays.count() * Native.Ray.STRUCT_BYTES; i += 4) {
          rays.buffer().putInt(i, word(words));
        }
        compared += rays.count();
      } else if (!addGeometry(name, words, scene, scenes) && !change(name, words, scene)) {
        compare(name, words, device, scene, rays);
      }
    }
    return compared;
  }

  private static void checkFileOfVectors(String name, String... features) throws IOException {
    for (Isa isa : new Isa[] {Isa.AUTO, Isa.SCALAR}) {
      Map<String, Scene> scenes = new HashMap<>();
      try (Device device = new Device(isa, 0, true);
          Scanner words = new Scanner(vectors(name))) {
        assertEquals("kiwami-conformance", words.next());
        assertEquals("1", words.next());
        int compared = 0;
        while (words.hasNext() && words.next().equals("scene")) {
          compared += checkScene(words, device, scenes);
        }
        assertTrue(compared > 100);
        scenes.values().forEach(Scene::close);
      }
    }
    note(features);
  }

  @Test
  public void answersAreTheSameToTheBit() throws IOException {
    checkFileOfVectors("vectors", "closest hit", "any hit", "multi hit", "counts");
    checkFileOfVectors("shapes", "spheres, discs, curves");
    checkFileOfVectors("moving_meshes", "moving meshes");
    checkFileOfVectors("instances", "instances");
    checkFileOfVectors("changes", "changes, refit");
  }

  @Test
  public void geometriesOfWrongSizesAreExceptions() {
    try (Device device = new Device();
        Scene scene = new Scene(device);
        Scene shown = new Scene(device)) {
      assertThrows(
          IllegalArgumentException.class, () -> scene.addDiscs(new float[8], new float[3], -1));
      assertThrows(
          IllegalArgumentException.class,
          () -> scene.addMovingMesh(new float[9], 2, new int[0], 0, 1, -1));
      assertThrows(
          IllegalArgumentException.class,
          () -> scene.addInstances(new Scene[] {shown}, new float[12], new int[2], null, -1));
      assertThrows(KiwamiException.class, () -> scene.addInstances(shown, new float[12]));
      assertThrows(IllegalArgumentException.class, () -> scene.updateVertices(0, new float[3]));
      shown.commit();
      float[] identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
      assertEquals(0, scene.addInstances(shown, identity));
      scene.commit();
    }
  }

  private static void assertError(String name, Runnable call) throws IOException {
    KiwamiException error = assertThrows(KiwamiException.class, call::run);
    String line =
        vectors("vectors").lines().filter(each -> each.startsWith("error " + name + " ")).findFirst().get();
    assertEquals(line, "error " + name + " " + error.result() + " " + error.getMessage());
  }

  @Test
  public void errorsAreTheSame() throws IOException {
    try (Device device = new Device();
        Scene scene = new Scene(device)) {
      assertError(
          "index_beyond_vertices",
          () -> scene.addMesh(new float[] {0, 0, 0, 1, 0, 0, 0, 1, 0}, new int[] {0, 1, 3}));
      assertError("unknown_geometry", () -> scene.remove(5));
      assertError(
          "parameter_out_of_bounds",
          () -> scene.setParameter(Native.KIWAMI_PARAMETER_BIN_COUNT, 1000));
      assertError("not_committed", () -> scene.closestHit(new Rays(1)));
      note("errors");
    }
  }

  @Test
  public void misuseIsAnException() {
    Device device = new Device();
    Scene scene = new Scene(device);
    device.close();
    device.close();
    assertThrows(
        IllegalArgumentException.class, () -> scene.addMesh(new float[4], new int[3]));
    scene.commit();
    assertThrows(
        IllegalArgumentException.class, () -> scene.closestHit(new Rays(2), new Hits(1)));
    assertEquals(0, scene.closestHit(new Rays(0)).count());
    scene.close();
    scene.close();
    assertThrows(IllegalStateException.class, scene::commit);
  }

  @Test
  public void manyThreadsTraceOneScene() throws InterruptedException {
    Scene scene = new Scene(new Device());
    scene.addMesh(new float[] {0, 0, 0, 1, 0, 0, 0, 1, 0}, new int[] {0, 1, 2});
    scene.commit();
    Rays rays = new Rays(100);
    for (int i = 0; i < rays.count(); ++i) {
      rays.setOrigin(i, i / 50f, 0.1f, -1);
      rays.setDirection(i, 0, 0, 1);
    }
    byte[] expected = bytes(scene.closestHit(rays));
    byte[][] found = new byte[4][];
    Thread[] threads = new Thread[found.length];
    for (int i = 0; i < threads.length; ++i) {
      int number = i;
      threads[i] = new Thread(() -> found[number] = bytes(scene.closestHit(rays)));
      threads[i].start();
    }
    for (int i = 0; i < threads.length; ++i) {
      threads[i].join();
      assertArrayEquals(expected, found[i]);
    }
  }

  private static byte[] bytes(Hits hits) {
    byte[] bytes = new byte[hits.buffer().capacity()];
    for (int i = 0; i < bytes.length; ++i) {
      bytes[i] = hits.buffer().get(i);
    }
    return bytes;
  }
}
