// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import com.sun.jna.Memory;
import com.sun.jna.Pointer;

/** An error of the library: its number, and its sentence as the message. */
public final class KiwamiException extends RuntimeException {
  private static final long serialVersionUID = 1L;
  private final int result;

  KiwamiException(int result, String sentence) {
    super(sentence);
    this.result = result;
  }

  /** The number of the C interface. */
  public int result() {
    return result;
  }

  /** Throws what a result stands for, unless it is success. */
  static void check(int result, Pointer device) {
    if (result == Native.KIWAMI_OK) {
      return;
    }
    Memory text = new Memory(1024);
    Native.kiwami_last_error(device, text, text.size());
    String sentence = text.getString(0, "UTF-8");
    if (sentence.isEmpty()) {
      sentence = Native.kiwami_result_name(result).getString(0);
    }
    throw new KiwamiException(result, sentence);
  }
}
