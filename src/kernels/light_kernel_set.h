// SPDX-License-Identifier: Apache-2.0
// The functions that an ISA offers for trees over lights, apart from what they read, so that a
// change there does not reach every user of the kernel table.
#pragma once

namespace kiwami {

struct LightTreeView;
struct LightBatch;

using LightKernel = void (*)(const LightTreeView& tree, const LightBatch& batch);

/// The kernels of one tree width; all null where the ISA has none.
struct LightKernels {
  LightKernel sample;        ///< one choice a receiver
  LightKernel pdf;           ///< the probability with which sample makes it
  LightKernel sample_split;  ///< adaptive splitting: up to max_choices a receiver
  LightKernel pdf_split;     ///< the probability with which a light is among them
};

}  // namespace kiwami
