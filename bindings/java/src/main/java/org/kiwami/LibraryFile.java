// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

/** Where the shared library is. */
final class LibraryFile {
  private LibraryFile() {}

  /** The property kiwami.library, the variable KIWAMI_LIBRARY, or the name for the loader. */
  static String path() {
    String chosen = System.getProperty("kiwami.library", System.getenv("KIWAMI_LIBRARY"));
    return chosen != null && !chosen.isEmpty() ? chosen : "kiwami";
  }
}
