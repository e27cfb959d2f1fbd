// SPDX-License-Identifier: Apache-2.0
#include "wide/wide_top_down.h"

#include <algorithm>

#include "core/error.h"
#include "wide/costed_tree.h"
#include "wide/forest_writer.h"

namespace kiwami {
namespace {

/// Binary nodes that the top of a subtree has at most. If subtrees ended at their roots, trees
/// would cost up to 10 % more.
constexpr uint32_t kMostTopNodes = 127;

/// The top of one subtree: nodes numbered from 0, parents before their children; the leaves are
/// clusters, numbered from 0.
struct SubtreeTop {
  uint32_t root;  ///< its place among the nodes near the root
  uint32_t node_count, cluster_count;
  BinaryNode nodes[kMostTopNodes];
  WideCluster clusters[kMostTopNodes / 2 + 1];
};

/// The subtrees of a build, as the wide nodes that they become.
template <int N>
class TopDownBuild : public TreeParts {
 public:
  TopDownBuild(const WideTopDownConfig& config, Memory& memory, const Parallel& parallel)
      : TreeParts(memory),
        config_(config),
        memory_(memory),
        parallel_(parallel),
        parts_(memory, parallel) {}

  WideDraft run(Array<BuildPrimitive> primitives) {
    Array<uint32_t> ids = BinnedSahBuilder::build_parts(std::move(primitives), config_.splits,
                                                        *this, memory_, parallel_);
    write_top();
    return parts_.join(std::move(ids));
  }

  void set_subtree_count(size_t count) override {
    subtrees_ = Array<SubtreeTop>(memory_, count);
    parts_.start_level(count);
  }

  void keep(size_t index, const BuiltSubtree& subtree) override {
    // Their order changes where leaves are joined.
    Array<uint32_t> ids(memory_, subtree.id_count);
    std::copy_n(subtree.ids, subtree.id_count, ids.begin());
    const CostedTree<N> tree(prices(), top_[subtree.root], subtree.nodes, subtree.node_count,
                             ids.data(), nullptr, memory_);
    Writer writer(tree, nullptr, config_.fill_nodes, subtree.node_count / 2 + 1, memory_);
    writer.start(subtree.ids);
    SubtreeTop& top = subtrees_[index];
    top.root = subtree.root;
    open_top(tree, writer, top);
    const uint32_t part = static_cast<uint32_t>(index);
    top.cluster_count = 0;
    for (uint32_t i = 0; i < top.node_count; ++i) {
      BinaryNode& node = top.nodes[i];
      if (!node.is_leaf()) continue;
      top.clusters[top.cluster_count] = writer.write(node.first, part);
      node.first = top.cluster_count++;
    }
    parts_.set(part, writer.take(memory_));
  }

 private:
  using Writer = ForestWriter<N, CostedTree<N>>;

  ClusterPrices prices() const {
    return {config_.splits.node_cost, config_.splits.leaf_cost, config_.leaf_width,
            top_[0].bounds.half_area()};
  }

  /// Opens the largest wide nodes that the tree would have by itself, one after the other. Leaves
  /// of the top name their trees.
  static void open_top(const CostedTree<N>& tree, const Writer& writer, SubtreeTop& top) {
    top.nodes[0] = {tree.box_of(tree.root()), tree.root(), 1};
    top.node_count = 1;
    // A wide node stands for at most N - 1 binary ones, of two children each.
    while (top.node_count + 2 * (N - 1) <= kMostTopNodes) {
      uint32_t largest = kMostTopNodes;
      float area = -1.0f;
      for (uint32_t i = 0; i < top.node_count; ++i) {
        const BinaryNode& node = top.nodes[i];
        if (!node.is_leaf() || tree.is_leaf(node.first)) continue;
        if (node.bounds.half_area() > area) {
          area = node.bounds.half_area();
          largest = i;
        }
      }
      if (largest == kMostTopNodes) return;
      open_node(tree, writer, largest, top);
    }
  }

  /// Adds the binary nodes between a wide node and its children.
  static void open_node(const CostedTree<N>& tree, const Writer& writer, uint32_t node,
                        SubtreeTop& top) {
    ChosenSlot chosen[N];
    const uint32_t count = writer.choose(top.nodes[node].first, chosen);
    const auto is_chosen = [&](uint32_t candidate) {
      return std::any_of(chosen, chosen + count,
                         [&](const ChosenSlot& slot) { return slot.binary_node == candidate; });
    };
    const uint32_t first_new = top.node_count;
    open_pair(tree, node, top);
    for (uint32_t i = first_new; i < top.node_count; ++i) {
      if (!is_chosen(top.nodes[i].first)) open_pair(tree, i, top);
    }
  }

  static void open_pair(const CostedTree<N>& tree, uint32_t node, SubtreeTop& top) {
    const uint32_t left = tree.left_child(top.nodes[node].first);
    top.nodes[node].first = top.node_count;
    top.nodes[node].count = 0;
    top.nodes[top.node_count++] = {tree.box_of(left), left, 1};
    top.nodes[top.node_count++] = {tree.box_of(left + 1), left + 1, 1};
  }

  /// The nodes near the root and the tops of all subtrees as one tree over clusters, and what it
  /// becomes.
  void write_top() {
    Array<WideCluster> clusters = collect_clusters();
    const Array<BinaryNode> nodes = collect_nodes();
    const uint32_t cluster_count = static_cast<uint32_t>(clusters.size());
    parts_.end_level(std::move(clusters));
    const WideCluster* below = parts_.clusters().data();
    const CostedTree<N> tree(prices(), nodes[0], nodes.data(), static_cast<uint32_t>(nodes.size()),
                             nullptr, below, memory_);
    Writer writer(tree, below, config_.fill_nodes, cluster_count, memory_);
    writer.start(nullptr);
    const uint32_t part = parts_.start_level(1);
    Array<WideCluster> root(memory_, 1);
    root[0] = writer.write(tree.root(), part);
    parts_.set(part, writer.take(memory_));
    parts_.end_level(std::move(root));
  }

  Array<WideCluster> collect_clusters() const {
    size_t count = 0;
    for (const SubtreeTop& subtree : subtrees_) count += subtree.cluster_count;
    Array<WideCluster> clusters(memory_, count);
    WideCluster* to = clusters.begin();
    for (const SubtreeTop& subtree : subtrees_) {
      to = std::copy_n(subtree.clusters, subtree.cluster_count, to);
    }
    return clusters;
  }

  Array<BinaryNode> collect_nodes() const {
    size_t count = top_.size();
    for (const SubtreeTop& subtree : subtrees_) count += subtree.node_count - 1;
    Array<BinaryNode> nodes(memory_, count);
    for (size_t i = 0; i < top_.size(); ++i) nodes[i] = top_[i];
    uint32_t next = static_cast<uint32_t>(top_.size()), first_cluster = 0;
    for (const SubtreeTop& subtree : subtrees_) {
      for (uint32_t i = 0; i < subtree.node_count; ++i) {
        BinaryNode node = subtree.nodes[i];
        // The root of a subtree stands among the nodes near the root.
        node.first += node.is_leaf() ? first_cluster : next - 1;
        nodes[i == 0 ? subtree.root : next + i - 1] = node;
      }
      next += subtree.node_count - 1;
      first_cluster += subtree.cluster_count;
    }
    return nodes;
  }

  const WideTopDownConfig& config_;
  Memory& memory_;
  const Parallel& parallel_;
  WideParts parts_;
  Array<SubtreeTop> subtrees_;
};

}  // namespace

WideDraft build_wide_top_down(Array<BuildPrimitive> primitives, const WideTopDownConfig& config,
                              Memory& memory, const Parallel& parallel) {
  if (primitives.empty()) return {};
  switch (config.width) {
    case 4:
      return TopDownBuild<4>(config, memory, parallel).run(std::move(primitives));
    case 8:
      return TopDownBuild<8>(config, memory, parallel).run(std::move(primitives));
    case 16:
      return TopDownBuild<16>(config, memory, parallel).run(std::move(primitives));
    default:
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "width is %u, expected 4, 8 or 16", config.width);
  }
}

}  // namespace kiwami
