/* SPDX-License-Identifier: Apache-2.0
 *
 * To be preloaded before Open3D 0.16, which gives its rays a mask of 0: an Embree that is built
 * with ray masks, as Debian's is, then lets them hit nothing. Gives them a mask of all ones. */
#include <dlfcn.h>
#include <embree3/rtcore.h>

/* Open3D's module keeps Embree to itself, so that dlsym(RTLD_NEXT) would not find it. */
static void* embree(const char* name) { return dlsym(dlopen("libembree3.so.3", RTLD_NOW), name); }

void rtcIntersect1M(RTCScene scene, struct RTCIntersectContext* context, struct RTCRayHit* rays,
                    unsigned int count, size_t stride) {
  __typeof__(&rtcIntersect1M) next = (__typeof__(&rtcIntersect1M))embree("rtcIntersect1M");
  for (unsigned int i = 0; i < count; ++i) {
    ((struct RTCRayHit*)(void*)((char*)rays + i * stride))->ray.mask = -1u;
  }
  next(scene, context, rays, count, stride);
}

void rtcOccluded1M(RTCScene scene, struct RTCIntersectContext* context, struct RTCRay* rays,
                   unsigned int count, size_t stride) {
  __typeof__(&rtcOccluded1M) next = (__typeof__(&rtcOccluded1M))embree("rtcOccluded1M");
  for (unsigned int i = 0; i < count; ++i) {
    ((struct RTCRay*)(void*)((char*)rays + i * stride))->mask = -1u;
  }
  next(scene, context, rays, count, stride);
}
