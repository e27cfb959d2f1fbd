// SPDX-License-Identifier: Apache-2.0
#include "measure/embree_refit.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <new>
#include <stdexcept>
#include <vector>

#include "measure/embree_scene.h"

namespace kiwami::tools {
namespace {

class RefittedScene : public EmbreeRefit {
 public:
  RefittedScene(const SceneFile& file, const std::string& config) {
    device_ = rtcNewDevice(config.c_str());
    if (device_ == nullptr) throw std::runtime_error("Embree cannot make a device of " + config);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    // Else Embree ignores what its geometries are to be built by, and builds the scene anew.
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    for (const Mesh& mesh : file.meshes) attach(mesh);
    rtcCommitScene(scene_);
    check();
  }

  ~RefittedScene() override {
    for (const Moving& mesh : meshes_) rtcReleaseGeometry(mesh.geometry);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  std::span<float> vertices(size_t mesh) override { return meshes_[mesh].vertices; }

  void refit() override {
    for (const Moving& mesh : meshes_) {
      rtcUpdateGeometryBuffer(mesh.geometry, RTC_BUFFER_TYPE_VERTEX, 0);
      rtcCommitGeometry(mesh.geometry);
    }
    rtcCommitScene(scene_);
    check();
  }

 private:
  struct Moving {
    RTCGeometry geometry;
    std::span<float> vertices;
  };

  void attach(const Mesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    float* const vertices = copy(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.vertices,
                                 mesh.vertex_count());
    copy(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.indices, mesh.triangle_count());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    meshes_.push_back({geometry, {vertices, mesh.vertices.size()}});
  }

  template <typename T>
  T* copy(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const std::vector<T>& data,
          size_t count) {
    if (count == 0) return nullptr;
    void* const buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, 3 * sizeof(T), count);
    if (buffer == nullptr) throw std::bad_alloc();
    std::copy(data.begin(), data.end(), static_cast<T*>(buffer));
    return static_cast<T*>(buffer);
  }

  void check() {
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) {
      throw std::runtime_error("Embree cannot refit the scene");
    }
  }

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::vector<Moving> meshes_;
};

}  // namespace

std::unique_ptr<EmbreeRefit> EmbreeRefit::create(const SceneFile& file, uint32_t isa,
                                                 uint32_t threads) {
  return std::make_unique<RefittedScene>(file, embree_config(isa, threads));
}

}  // namespace kiwami::tools
