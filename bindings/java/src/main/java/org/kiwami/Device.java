// SPDX-License-Identifier: Apache-2.0
package org.kiwami;

import com.sun.jna.Memory;
import com.sun.jna.Pointer;
import java.lang.ref.Cleaner;

/** Kernels of one instruction set and the threads that run them. */
public final class Device implements AutoCloseable {
  static final Cleaner CLEANER = Cleaner.create();

  private final Pointer object;
  private final Cleaner.Cleanable cleanable;

  /** The best kernels of this machine on all its processors. */
  public Device() {
    this(Isa.AUTO, 0, false);
  }

  /**
   * Makes a device.
   *
   * @param threadCount threads that builds and batches use at once; 0: one per processor
   * @param validate check the arguments of the trace calls in the library too
   */
  public Device(Isa isa, int threadCount, boolean validate) {
    Memory desc = new Memory(Native.DeviceDesc.STRUCT_BYTES);
    KiwamiException.check(Native.kiwami_device_desc_init(desc, Native.DeviceDesc.STRUCT_BYTES), null);
    desc.setInt(Native.DeviceDesc.ISA, isa.number);
    desc.setInt(Native.DeviceDesc.THREAD_COUNT, threadCount);
    desc.setInt(Native.DeviceDesc.FLAGS, validate ? Native.KIWAMI_DEVICE_VALIDATE : 0);
    Memory made = new Memory(com.sun.jna.Native.POINTER_SIZE);
    KiwamiException.check(Native.kiwami_device_create(desc, made), null);
    object = made.getPointer(0);
    Pointer owned = object;
    cleanable = CLEANER.register(this, () -> Native.kiwami_device_release(owned));
  }

  Pointer object() {
    return object;
  }

  /** The lower-case name of the instruction set whose kernels run. */
  public String isaName() {
    Memory info = new Memory(Native.DeviceInfo.STRUCT_BYTES);
    info.setInt(Native.DeviceInfo.STRUCT_SIZE, Native.DeviceInfo.STRUCT_BYTES);
    KiwamiException.check(Native.kiwami_device_get_info(object, info), object);
    return Native.kiwami_isa_name(info.getInt(Native.DeviceInfo.ISA)).getString(0);
  }

  /** Lets go of the device; scenes of it live on. Closing twice is allowed. */
  @Override
  public void close() {
    cleanable.clean();
  }
}
