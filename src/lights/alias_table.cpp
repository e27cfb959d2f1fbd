// SPDX-License-Identifier: Apache-2.0
#include "lights/alias_table.h"

#include <algorithm>

namespace kiwami {

AliasTable::AliasTable(const Array<double>& weights, Memory& memory) {
  double total = 0.0;
  for (const double weight : weights) total += weight;
  if (!(total > 0.0)) return;
  const auto count = static_cast<uint32_t>(weights.size());
  entries_ = Array<Entry>(memory, count);
  Array<double> shares(memory, count);
  // Those that want less than an entry from the front, the others from the back.
  Array<uint32_t> order(memory, count);
  uint32_t small = 0, large = count;
  for (uint32_t i = 0; i < count; ++i) {
    entries_[i] = {weights[i] / total, 1.0f, i};
    shares[i] = entries_[i].probability * count;
    order[shares[i] < 1.0 ? small++ : --large] = i;
  }
  uint32_t next = 0;
  while (next < small && large < count) {
    const uint32_t poor = order[next++], rich = order[large];
    entries_[poor].threshold = static_cast<float>(shares[poor]);
    entries_[poor].alias = rich;
    // What a rounded threshold gives to the poor is the rich one's loss.
    shares[rich] -= 1.0 - static_cast<double>(entries_[poor].threshold);
    if (shares[rich] < 1.0) {
      ++large;
      order[small++] = rich;
    }
  }
  // What is left wants a whole entry, up to rounding; but nothing wants none.
  while (next < small) {
    const uint32_t poor = order[next++];
    if (weights[poor] > 0.0) continue;
    const auto heaviest = std::max_element(weights.begin(), weights.end());
    entries_[poor].threshold = 0.0f;
    entries_[poor].alias = static_cast<uint32_t>(heaviest - weights.begin());
  }
}

Draw AliasTable::draw(double random) const {
  const double place = random * static_cast<double>(entries_.size());
  const auto index =
      std::min(static_cast<uint32_t>(place), static_cast<uint32_t>(entries_.size() - 1));
  const Entry& entry = entries_[index];
  const double rest = place - static_cast<double>(index);
  const double threshold = static_cast<double>(entry.threshold);
  if (rest < threshold) return {index, std::min(rest / threshold, Draw::kGreatestRandom)};
  return {entry.alias, std::min((rest - threshold) / (1.0 - threshold), Draw::kGreatestRandom)};
}

}  // namespace kiwami
