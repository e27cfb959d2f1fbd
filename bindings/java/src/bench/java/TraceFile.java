// SPDX-License-Identifier: Apache-2.0
import java.io.IOException;
import java.nio.file.Files;
import java.nio.file.Paths;
import org.kiwami.Device;
import org.kiwami.Hits;
import org.kiwami.Rays;
import org.kiwami.Scene;

/** See bindings/benchmark/trace_file.c. */
public final class TraceFile {
  private TraceFile() {}

  public static void main(String[] arguments) throws IOException {
    byte[] bytes = Files.readAllBytes(Paths.get(arguments[1]));
    Rays rays = new Rays(bytes.length / 48);
    rays.buffer().put(bytes);
    rays.buffer().rewind();
    try (Device device = new Device();
        Scene scene = Scene.load(device, arguments[0], true, true)) {
      Hits hits = new Hits(rays.count());
      for (int round = Integer.parseInt(arguments[2]); round > 0; --round) {
        long began = System.nanoTime();
        scene.closestHit(rays, hits);
        System.out.println(1e-9 * (System.nanoTime() - began));
      }
    }
  }
}
