// SPDX-License-Identifier: Apache-2.0
// Any sequence of calls, with arguments that are wrong in every way that a caller can be wrong and
// a library can notice: NULL, released or foreign handles' places, NaN, counts and strides beyond
// all limits, sizes of structs that are none. Each call comes back with one of the documented
// results, with a sentence if it is an error, and at the end all memory is back.
#include <array>

#include "fuzz/call_geometries.h"
#include "support/exercise.h"
#include "support/random.h"

namespace kiwami_fuzz {
namespace {

/// Few, so that calls that belong together meet.
constexpr uint32_t kSlots = 2;
constexpr uint32_t kMostCalls = 96;

/// One run.
class Session {
 public:
  Session(Input& input, CountedMemory& memory) : arguments_(input) {
    const uint32_t flags = input.below(2) == 0 ? KIWAMI_DEVICE_VALIDATE : 0;
    validates_ = flags != 0;
    device_ = make_device(KIWAMI_ISA_AUTO, flags, &memory);
    other_device_ = make_device(KIWAMI_ISA_SCALAR, flags, &memory);
  }

  void run() {
    for (uint32_t i = 0; i < kMostCalls && !arguments_.is_empty(); ++i) call();
  }

 private:
  void call() {
    using Step = void (Session::*)();
    constexpr Step kSteps[] = {
        &Session::create_mesh,   &Session::create_mesh,    &Session::create_scene,
        &Session::attach,        &Session::attach,         &Session::detach,
        &Session::set_parameter, &Session::set_optimizers, &Session::commit,
        &Session::commit,        &Session::trace,          &Session::trace,
        &Session::trace_fields,  &Session::trace_many,     &Session::get_info,
        &Session::create_other,  &Session::create_other,   &Session::edit_scene,
        &Session::edit_mesh,     &Session::edit_opacity,   &Session::refit,
        &Session::sample_lights, &Session::get_bvh,        &Session::build_bvh,
        &Session::refit_bvh,     &Session::save_and_load,  &Session::exercise_all,
        &Session::release};
    (this->*kSteps[below(std::size(kSteps))])();
  }

  bool rarely() { return arguments_.rarely(); }
  uint32_t below(uint32_t count) { return arguments_.below(count); }
  uint32_t whole() { return arguments_.whole(); }
  float number() { return arguments_.number(); }
  uint32_t slot() { return below(kSlots); }
  kiwami_scene* scene() { return rarely() ? nullptr : scenes_[slot()].get(); }
  kiwami_geometry* geometry() { return rarely() ? nullptr : geometries_[slot()].get(); }
  kiwami_bvh* bvh() { return rarely() ? nullptr : bvhs_[slot()].get(); }
  kiwami_device* device() {
    if (rarely()) return nullptr;
    return rarely() ? other_device_.get() : device_.get();
  }

  void create_mesh() { geometries_[slot()] = make_mesh(arguments_, device()); }

  void create_other() {
    Geometry made;
    switch (arguments_.below(4)) {
      case 0:
        made = make_shapes(arguments_, device());
        break;
      case 1:
        made = make_moving_mesh(arguments_, device());
        break;
      case 2:
        made = make_user_geometry(arguments_, device());
        break;
      default:
        made = make_instances(arguments_, device(), scene());
        break;
    }
    geometries_[slot()] = std::move(made);
  }

  void create_scene() {
    kiwami_scene* made = nullptr;
    check(kiwami_scene_create(device(), &made));
    scenes_[slot()].reset(made);
  }

  void attach() {
    uint32_t id = 0;
    check(kiwami_scene_attach(scene(), geometry(), rarely() ? nullptr : &id));
  }

  void detach() { check(kiwami_scene_detach(scene(), rarely() ? whole() : below(6))); }

  void set_parameter() {
    const double value = rarely() ? static_cast<double>(number()) : below(20);
    check(kiwami_scene_set_parameter(scene(), rarely() ? whole() : below(48), value));
  }

  void set_optimizers() {
    uint32_t methods[12];
    for (uint32_t& method : methods) method = rarely() ? whole() : below(9);
    check(kiwami_scene_set_optimizers(scene(), rarely() ? nullptr : methods, below(12)));
  }

  void commit() {
    kiwami_scene* const target = scene();
    if (check(kiwami_scene_commit(target)) != KIWAMI_OK) return;
    require(kiwami_scene_validate(target) == KIWAMI_OK, "a tree that is not valid");
  }

  void edit_scene() {
    kiwami_scene* const target = scene();
    check(kiwami_scene_enable(target, below(4), static_cast<int32_t>(below(2))));
    check(kiwami_scene_replace(target, below(4), geometry()));
  }

  void edit_mesh() {
    const std::vector<float> vertices = arguments_.numbers(size_t{3} * kMostVertices);
    kiwami_geometry* const target = geometry();
    check(kiwami_triangle_mesh_update_vertices(target, rarely() ? nullptr : vertices.data(), 0,
                                               rarely() ? 5 : 0));
    check(kiwami_geometry_set_mask(target, whole()));
  }

  void edit_opacity() { set_opacity(arguments_, geometry()); }

  /// A refit or a commit, which is cancelled after some steps.
  void refit() {
    kiwami_scene* const target = scene();
    uint32_t steps = below(12);
    check(kiwami_scene_set_progress(
        target,
        [](void* user, double) {
          uint32_t& left = *static_cast<uint32_t*>(user);
          return int32_t{left == 0 ? 1 : (--left, 0)};
        },
        &steps));
    check(below(2) == 0 ? kiwami_scene_refit(target) : kiwami_scene_commit(target));
    check(kiwami_scene_set_progress(target, nullptr, nullptr));
    check(kiwami_scene_refit(target));
  }

  void sample_lights() {
    kiwami_light_tree* tree = nullptr;
    if (check(kiwami_light_tree_create(device(), nullptr, &tree)) != KIWAMI_OK) return;
    std::vector<kiwami_light> lights(below(kMostElements));
    for (kiwami_light& light : lights) {
      light = {};
      light.type = rarely() ? whole() : below(8);
      light.flags = below(2);
      for (float& coordinate : light.points) coordinate = number();
      for (float& coordinate : light.direction) coordinate = number();
      light.radius = number();
      light.cos_inner = 1.0f;
      light.cos_outer = number();
      light.power = rarely() ? number() : 1.0f;
      light.link_mask = ~uint64_t{0};
      // One by one: a wrong one refuses all.
      check(kiwami_light_tree_add_lights(tree, &light, 0, 1, nullptr));
    }
    std::vector<kiwami_light_receiver> receivers(4);
    std::vector<kiwami_light_choice> choices(4);
    const std::vector<float> values = arguments_.numbers(sizeof(kiwami_light_receiver));
    std::memcpy(static_cast<void*>(receivers.data()), values.data(),
                receivers.size() * sizeof receivers[0]);
    check(kiwami_light_sample(tree, receivers.data(), 0, choices.data(), 0, 4, nullptr));
    check(kiwami_light_tree_commit(tree));
    check(kiwami_light_sample(tree, receivers.data(), 0, choices.data(), 0, 4, nullptr));
    check(kiwami_light_tree_refit(tree));
    kiwami_light_tree_release(tree);
  }

  std::vector<kiwami_ray> rays(size_t count) {
    std::vector<kiwami_ray> made(count);
    for (kiwami_ray& ray : made) {
      ray = {number(), number(), number(), number(), number(), number(),
             number(), number(), number(), ~0u,      0u,       0u};
      if (rarely()) ray.mask = whole();
      if (rarely()) ray.flags = whole();
    }
    return made;
  }

  /// A query with flags that may be unknown; NULL for none.
  const kiwami_query* query() {
    if (below(2) == 0) return nullptr;
    kiwami_query_init(&query_, sizeof query_);
    query_.flags = rarely() ? whole() : below(2);
    if (rarely()) query_.struct_size = arguments_.wrong_size(sizeof query_);
    return &query_;
  }

  void trace() {
    const size_t count = below(kMostElements);
    const std::vector<kiwami_ray> given = rays(count);
    std::vector<kiwami_hit> hits(count);
    std::vector<uint8_t> occluded(count);
    // Arguments that trace calls trust are wrong only where they are to be checked.
    const bool is_wrong = validates_ && rarely();
    const size_t stride = is_wrong ? 1 + whole() % 47 : 0;
    kiwami_scene* const target = scene();
    check(kiwami_closest_hit(target, is_wrong && rarely() ? nullptr : given.data(), stride,
                             hits.data(), 0, count, query()));
    check(kiwami_any_hit(target, given.data(), stride, occluded.data(), 0, count, query()));
    if (is_wrong) {
      check(kiwami_closest_hit(target, given.data(), SIZE_MAX / 4, hits.data(), 0, 64, nullptr));
      check(kiwami_closest_hit(target, given.data(), 0, hits.data(), 0, SIZE_MAX / 2, nullptr));
    }
  }

  void trace_fields() {
    const size_t count = below(kMostElements);
    const std::vector<kiwami_ray> given = rays(count);
    std::vector<kiwami_hit> hits(count);
    kiwami_ray_fields fields;
    kiwami_hit_fields answers;
    check(kiwami_ray_fields_init(&fields, sizeof fields));
    check(kiwami_hit_fields_init(&answers, sizeof answers));
    kiwami_input_field* const inputs[] = {
        &fields.origin_x,    &fields.origin_y,    &fields.origin_z,    &fields.tmin,
        &fields.direction_x, &fields.direction_y, &fields.direction_z, &fields.tmax};
    for (size_t i = 0; i < std::size(inputs); ++i) {
      const bool is_absent = rarely();
      *inputs[i] = {
          is_absent || count == 0 ? nullptr : reinterpret_cast<const float*>(given.data()) + i,
          rarely() ? 0 : sizeof(kiwami_ray)};
    }
    if (count != 0) answers.t = {&hits[0].t, sizeof(kiwami_hit)};
    if (count != 0 && rarely()) answers.primitive_id = {&hits[0].primitive_id, sizeof(kiwami_hit)};
    if (rarely()) fields.struct_size = arguments_.wrong_size(sizeof fields);
    if (rarely()) answers.struct_size = arguments_.wrong_size(sizeof answers);
    check(kiwami_closest_hit_fields(scene(), rarely() ? nullptr : &fields,
                                    rarely() ? nullptr : &answers, count, query()));
  }

  void trace_many() {
    const size_t count = below(kMostElements);
    const std::vector<kiwami_ray> given = rays(count);
    std::vector<kiwami_hit> hits(below(64));
    std::vector<uint64_t> offsets(count + 1);
    std::vector<uint32_t> counts(count);
    kiwami_scene* const target = scene();
    check(kiwami_multi_hit(target, given.data(), 0, count, rarely() ? whole() : below(6),
                           hits.data(), hits.size(), offsets.data(), query()));
    check(kiwami_count_hits(target, given.data(), 0, counts.data(), 0, count, query()));
  }

  void get_info() {
    kiwami_scene_info scene_info{};
    kiwami_device_info device_info{};
    scene_info.struct_size = rarely() ? whole() % 144 : sizeof scene_info;
    device_info.struct_size = rarely() ? whole() % 32 : sizeof device_info;
    check(kiwami_scene_get_info(scene(), rarely() ? nullptr : &scene_info));
    check(kiwami_device_get_info(device(), rarely() ? nullptr : &device_info));
    kiwami_method_name(whole(), whole());
    kiwami_isa_name(whole());
    kiwami_result_name(static_cast<kiwami_result>(whole()));
    check(kiwami_parameter_bounds(whole(), nullptr, nullptr, nullptr));
  }

  void get_bvh() {
    kiwami_bvh* made = nullptr;
    check(kiwami_scene_get_bvh(scene(), &made));
    bvhs_[slot()].reset(made);
  }

  void build_bvh() {
    const size_t count = below(kMostElements);
    const std::vector<float> boxes = arguments_.numbers(6 * count);
    kiwami_parameter_value parameters[3];
    for (kiwami_parameter_value& parameter : parameters) {
      parameter = {below(32), rarely() ? 1u : 0u, static_cast<double>(below(16))};
    }
    uint32_t optimizer = below(8);
    kiwami_bvh_desc desc;
    check(kiwami_bvh_desc_init(&desc, sizeof desc));
    constexpr uint32_t kWidths[] = {0, 2, 4, 8, 16, 3, 0xFFFFFFFF};
    desc.width = kWidths[below(std::size(kWidths))];
    if (below(3) != 0) {
      desc.boxes = boxes.data();
      desc.box_count = count;
    }
    if (below(3) == 0) desc.geometry = geometry();
    if (rarely()) desc.box_stride = 1 + below(23);
    if (below(2) == 0) desc.parameters = parameters;
    desc.parameter_count = below(4);
    if (below(2) == 0) desc.optimizers = &optimizer;
    desc.optimizer_count = below(2);
    if (rarely()) desc.box_count = arguments_.huge();
    kiwami_bvh* made = nullptr;
    check(kiwami_bvh_build(device(), &desc, &made));
    bvhs_[slot()].reset(made);
  }

  void refit_bvh() {
    const size_t count = below(kMostElements);
    const std::vector<float> boxes = arguments_.numbers(6 * count);
    check(kiwami_bvh_refit(bvh(), rarely() ? nullptr : boxes.data(), 0, count));
  }

  void save_and_load() {
    std::vector<unsigned char> file(size_t{1} << 17);
    kiwami_save_desc save;
    kiwami_load_desc load;
    check(kiwami_save_desc_init(&save, sizeof save));
    check(kiwami_load_desc_init(&load, sizeof load));
    load.data = save.data = file.data();
    save.capacity = rarely() ? below(4096) : file.size();
    kiwami_scene* made = nullptr;
    kiwami_bvh* made_bvh = nullptr;
    if (below(2) == 0) {
      check(kiwami_scene_save(scene(), rarely() ? nullptr : &save, &load.size));
      spoil(load, file);
      check(kiwami_scene_load(device(), &load, &made));
      scenes_[slot()].reset(made);
    } else {
      check(kiwami_bvh_save(bvh(), &save, &load.size));
      spoil(load, file);
      check(kiwami_bvh_load(device(), &load, &made_bvh));
      bvhs_[slot()].reset(made_bvh);
    }
  }

  void spoil(kiwami_load_desc& load, std::vector<unsigned char>& file) {
    if (load.size > file.size()) load.size = file.size();
    if (rarely()) file[arguments_.bits() % file.size()] ^= 4;
    if (rarely()) load.flags = whole();
    // What is changed must not be trusted.
    load.flags &= ~uint32_t{KIWAMI_LOAD_TRUSTED | KIWAMI_LOAD_MAP};
    if (rarely()) load.bvh_width = below(20);
    if (rarely()) load.data = nullptr;
    if (rarely()) load.path = "/nowhere/at/all";
  }

  void exercise_all() {
    if (kiwami_scene* const target = scene()) kiwami_tests::exercise(target);
    if (kiwami_bvh* const target = bvh()) kiwami_tests::exercise(target);
  }

  /// In any order: what others still need stays.
  void release() {
    switch (below(4)) {
      case 0:
        geometries_[slot()].reset();
        break;
      case 1:
        scenes_[slot()].reset();
        break;
      case 2:
        bvhs_[slot()].reset();
        break;
      default:
        device_.reset();
        device_ = make_device_again();
        break;
    }
  }

  /// Geometries and scenes of the old device live on, and do not go with the new one.
  Device make_device_again() {
    kiwami_device_desc desc;
    check(kiwami_device_desc_init(&desc, sizeof desc));
    desc.thread_count = 1;
    desc.flags = validates_ ? uint32_t{KIWAMI_DEVICE_VALIDATE} : 0;
    kiwami_device* made = nullptr;
    check(kiwami_device_create(&desc, &made));
    return Device(made);
  }

  Arguments arguments_;
  bool validates_ = false;
  Device device_, other_device_;
  std::array<Geometry, kSlots> geometries_;
  std::array<Scene, kSlots> scenes_;
  std::array<Bvh, kSlots> bvhs_;
  kiwami_query query_{};
};

}  // namespace

std::vector<Bytes> make_seeds() {
  std::vector<Bytes> seeds;
  kiwami_tests::Random random(5);
  for (const size_t size : {100u, 500u, 3000u, 8000u}) {
    for (int i = 0; i < 8; ++i) {
      Bytes seed(size);
      for (unsigned char& byte : seed) byte = static_cast<unsigned char>(random.bits());
      seeds.push_back(seed);
    }
  }
  return seeds;
}

}  // namespace kiwami_fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace kiwami_fuzz;
  CountedMemory memory;
  {
    Input input(data, size);
    Session(input, memory).run();
  }
  require(memory.live == 0, "memory that is not given back");
  return 0;
}
