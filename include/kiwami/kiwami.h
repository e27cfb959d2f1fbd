/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: acceleration structures for ray tracing. This header is all of the library.
 */
#ifndef KIWAMI_H
#define KIWAMI_H

#include "base.h"
#include "binary_tree.h"
#include "bvh.h"
#include "device.h"
#include "distribution.h"
#include "export.h"
#include "geometry.h"
#include "instances.h"
#include "io.h"
#include "light.h"
#include "moving_instances.h"
#include "moving_mesh.h"
#include "opacity.h"
#include "scene.h"
#include "shapes.h"
#include "surface.h"
#include "tetrahedra.h"
#include "trace.h"
#include "user_geometry.h"

#endif
