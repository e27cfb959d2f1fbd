// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import static org.junit.Assert.assertEquals;
import static org.junit.Assert.assertThrows;
import static org.junit.Assert.assertTrue;

import java.io.IOException;
import java.nio.ByteBuffer;
import java.util.Scanner;
import org.junit.Test;

/** Sets of lights against the answers that every binding must give. */
public class LightTest {
  private static void readWords(Scanner words, ByteBuffer buffer) {
    for (int i = 0; i < buffer.capacity(); i += 4) {
      buffer.putInt(i, ConformanceTest.word(words));
    }
  }

  private static void addMesh(Scanner words, LightTree lights) {
    boolean isTwoSided = ConformanceTest.word(words) != 0;
    float radiance = Float.intBitsToFloat(ConformanceTest.word(words));
    int[] counts = ConformanceTest.words(words, 2);
    lights.addMesh(
        ConformanceTest.floats(words, 3 * counts[0]),
        ConformanceTest.words(words, 3 * counts[1]),
        radiance,
        isTwoSided);
  }

  /** Plays a set of lights; returns how many choices were compared. */
  private static int play(Scanner words, Device device) {
    int compared = 0;
    LightReceivers receivers = null;
    LightChoices choices = null;
    try (LightTree lights = new LightTree(device, ConformanceTest.word(words))) {
      for (String word = words.next(); !word.equals("end"); word = words.next()) {
        switch (word) {
          case "light":
            Lights added = new Lights(ConformanceTest.word(words));
            readWords(words, added.buffer());
            lights.addLights(added);
            break;
          case "light_mesh":
            addMesh(words, lights);
            break;
          case "powers":
            int first = ConformanceTest.word(words);
            lights.setPowers(
                first, ConformanceTest.floats(words, ConformanceTest.word(words)));
            break;
          case "commit":
            lights.commit();
            break;
          case "refit":
            lights.refit();
            break;
          case "receivers":
            receivers = new LightReceivers(ConformanceTest.word(words));
            readWords(words, receivers.buffer());
            break;
          case "choices":
            choices = lights.sample(receivers);
            for (int i = 0; i < choices.buffer().capacity(); i += 4) {
              assertEquals(ConformanceTest.word(words), choices.buffer().getInt(i));
            }
            compared += choices.count();
            break;
          default:
            assertEquals("pdf", word);
            for (float each : lights.pdf(receivers, choices)) {
              assertEquals(ConformanceTest.word(words), Float.floatToRawIntBits(each));
            }
        }
      }
    }
    return compared;
  }

  @Test
  public void choicesAreTheSameToTheBit() throws IOException {
    for (Isa isa : new Isa[] {Isa.AUTO, Isa.SCALAR}) {
      try (Device device = new Device(isa, 0, true);
          Scanner words = new Scanner(ConformanceTest.vectors("lights"))) {
        assertEquals("kiwami-conformance", words.next());
        assertEquals("1", words.next());
        int compared = 0;
        while (words.hasNext() && words.next().equals("lights")) {
          compared += play(words, device);
        }
        assertTrue(compared > 100);
      }
    }
    ConformanceTest.note("many lights");
  }

  @Test
  public void badLightsAreExceptions() {
    Device device = new Device();
    assertThrows(KiwamiException.class, () -> new LightTree(device, 3));
    LightTree lights = new LightTree(device);
    device.close();
    LightReceivers receivers = new LightReceivers(1);
    receivers.setNormal(0, 0, 0, 1);
    receivers.setRandom(0, 0.5);
    assertThrows(KiwamiException.class, () -> lights.sample(receivers));
    assertThrows(KiwamiException.class, () -> lights.setPowers(0, new float[1]));
    assertThrows(KiwamiException.class, () -> lights.addMesh(new float[3], new int[] {0, 0, 1}));
    assertThrows(IllegalArgumentException.class, () -> lights.addMesh(new float[4], new int[3]));
    Lights added = new Lights(1);
    added.setPower(0, -1);
    assertThrows(KiwamiException.class, () -> lights.addLights(added));
    added.setKind(0, Lights.Kind.SPHERE);
    added.setPoint(0, 0, 0, 0, 5);
    added.setRadius(0, 1);
    added.setPower(0, 2);
    added.setUserId(0, 7);
    assertEquals(0, lights.addLights(added));
    lights.commit();
    LightChoices choices = lights.sample(receivers);
    assertEquals(7, choices.userId(0));
    assertEquals(-1, choices.instanceId(0));
    assertEquals(1, choices.probability(0), 0);
    assertThrows(
        IllegalArgumentException.class, () -> lights.pdf(new LightReceivers(2), choices));
    lights.close();
    lights.close();
    assertThrows(IllegalStateException.class, lights::commit);
  }
}
