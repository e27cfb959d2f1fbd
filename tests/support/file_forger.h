// SPDX-License-Identifier: Apache-2.0
// Files as an attacker writes them: any contents, with the checksums that belong to them.
#pragma once

#include <cstdint>
#include <vector>

namespace kiwami_tests {

using Bytes = std::vector<unsigned char>;

/// Gives the header, the directory and all sections within the file the checksums of what they
/// hold, and the header the size. Too short a file stays as it is.
void forge_checksums(Bytes& file);

/// One line of the directory of a file that a library wrote.
struct ForgedSection {
  uint32_t type;
  uint64_t offset;
  uint64_t bytes;
};
std::vector<ForgedSection> sections_of(const Bytes& file);

}  // namespace kiwami_tests
