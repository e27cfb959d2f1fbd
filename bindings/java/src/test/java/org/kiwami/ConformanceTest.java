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
import java.util.List;
import java.util.Scanner;
import org.junit.Test;

/** The answers that every binding must give, to the bit. */
public class ConformanceTest {
  private static String vectors() throws IOException {
    return new String(
        Files.readAllBytes(Paths.get(System.getProperty("kiwami.vectors"))),
        StandardCharsets.UTF_8);
  }

  /** Notes that features were found right, for the table of the documents. */
  private static void note(String... features) throws IOException {
    String path = System.getenv("KIWAMI_FEATURES");
    if (path != null) {
      Files.write(
          Paths.get(path), List.of(features), StandardOpenOption.CREATE, StandardOpenOption.APPEND);
    }
  }

  private static int word(Scanner words) {
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

  private static void readMesh(Scanner words, Scene scene) {
    int mask = word(words);
    float[] vertices = new float[3 * word(words)];
    int[] triangles = new int[3 * word(words)];
    for (int i = 0; i < vertices.length; ++i) {
      vertices[i] = Float.intBitsToFloat(word(words));
    }
    for (int i = 0; i < triangles.length; ++i) {
      triangles[i] = word(words);
    }
    scene.addMesh(vertices, triangles, mask);
  }

  private static int checkScene(Scanner words, Device device) throws IOException {
    try (Scene scene = new Scene(device)) {
      words.next();
      String name = words.next();
      for (; name.equals("mesh"); name = words.next()) {
        readMesh(words, scene);
      }
      assertEquals("rays", name);
      Rays rays = new Rays(word(words));
      for (int i = 0; i < rays.count() * Native.Ray.STRUCT_BYTES; i += 4) {
        rays.buffer().putInt(i, word(words));
      }
      scene.commit();
      assertEquals("closest_hit", words.next());
      Hits hits = scene.closestHit(rays);
      for (int i = 0; i < rays.count(); ++i) {
        assertHit(words, hits, i);
      }
      assertEquals("any_hit", words.next());
      for (boolean occluded : scene.anyHit(rays)) {
        assertEquals(word(words) == 1, occluded);
      }
      for (name = words.next(); name.equals("multi_hit"); name = words.next()) {
        checkMultiHit(words, scene, rays);
      }
      if (name.equals("file")) {
        checkFile(words, device, scene, rays);
        name = words.next();
      }
      assertEquals("end", name);
      note("closest hit", "any hit", "multi hit", "counts");
      return rays.count();
    }
  }

  @Test
  public void answersAreTheSameToTheBit() throws IOException {
    for (Isa isa : new Isa[] {Isa.AUTO, Isa.SCALAR}) {
      try (Device device = new Device(isa, 0, true);
          Scanner words = new Scanner(vectors())) {
        assertEquals("kiwami-conformance", words.next());
        assertEquals("1", words.next());
        int compared = 0;
        while (words.next().equals("scene")) {
          compared += checkScene(words, device);
        }
        assertTrue(compared > 100);
      }
    }
  }

  private static void assertError(String name, Runnable call) throws IOException {
    KiwamiException error = assertThrows(KiwamiException.class, call::run);
    String line =
        vectors().lines().filter(each -> each.startsWith("error " + name + " ")).findFirst().get();
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
