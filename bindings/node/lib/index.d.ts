// SPDX-License-Identifier: Apache-2.0
export type Isa = 'auto' | 'scalar' | 'sse' | 'avx2' | 'avx512';

/** An error of the library: its number as `result`, its sentence as the message. */
export class KiwamiError extends Error {
  readonly result: number;
}

export class Device {
  constructor(options?: { isa?: Isa; threads?: number; validate?: boolean });
  readonly isa: string;
  close(): void;
}

export class Rays {
  constructor(count: number);
  static from(
    origins: ArrayLike<number> & { slice(first: number, end: number): ArrayLike<number> },
    directions: ArrayLike<number> & { slice(first: number, end: number): ArrayLike<number> },
    options?: { tmin?: number; tmax?: number; mask?: number },
  ): Rays;
  readonly count: number;
  /** 12 words a ray, as kiwami_ray of trace.h. */
  readonly floats: Float32Array;
  /** The same memory. */
  readonly words: Uint32Array;
  set(
    ray: number,
    origin: ArrayLike<number>,
    direction: ArrayLike<number>,
    tmin?: number,
    tmax?: number,
  ): void;
}

export class Hits {
  constructor(count: number);
  readonly count: number;
  /** 9 words a hit, as kiwami_hit of trace.h. */
  readonly floats: Float32Array;
  /** The same memory. */
  readonly words: Uint32Array;
  t(hit: number): number;
  u(hit: number): number;
  v(hit: number): number;
  normal(hit: number): Float32Array;
  primitiveId(hit: number): number;
  geometryId(hit: number): number;
  instanceId(hit: number): number;
  isHit(hit: number): boolean;
}

export interface MultiHits {
  /** The hits of ray i are offsets[i] to offsets[i + 1] - 1. */
  offsets: Float64Array;
  hits: Hits;
}

export class Scene {
  constructor(device?: Device);
  addMesh(
    vertices: ArrayLike<number>,
    triangles: ArrayLike<number>,
    options?: { mask?: number },
  ): number;
  addMovingMesh(
    vertices: ArrayLike<number>,
    stepCount: number,
    triangles: ArrayLike<number>,
    options?: { times?: [number, number]; mask?: number },
  ): number;
  addSpheres(points: ArrayLike<number>, options?: { mask?: number }): number;
  addDiscs(
    points: ArrayLike<number>,
    normals: ArrayLike<number>,
    options?: { mask?: number },
  ): number;
  addCurves(
    points: ArrayLike<number>,
    segments: ArrayLike<number>,
    options?: { mask?: number },
  ): number;
  addInstances(
    scenes: Scene[],
    transforms: ArrayLike<number>,
    options?: { sceneIndices?: ArrayLike<number>; masks?: ArrayLike<number>; mask?: number },
  ): number;
  updateVertices(geometryId: number, vertices: ArrayLike<number>): void;
  enable(geometryId: number, isEnabled?: boolean): void;
  remove(geometryId: number): void;
  setParameter(parameter: number, value: number): void;
  commit(): Promise<void>;
  commitSync(): void;
  refit(): Promise<void>;
  refitSync(): void;
  save(path: string): void;
  static load(
    path: string,
    options?: { device?: Device; map?: boolean; trusted?: boolean },
  ): Scene;
  closestHit(rays: Rays, hits?: Hits): Hits;
  anyHit(rays: Rays, occluded?: Uint8Array): Uint8Array;
  multiHit(rays: Rays, maxHits?: number): MultiHits;
  countHits(rays: Rays, counts?: Uint32Array): Uint32Array;
  close(): void;
}

/** See kiwami_light of light.h for which fields each kind has. */
export interface Light {
  kind?: 'point' | 'spot' | 'triangle' | 'quad' | 'sphere' | 'disc' | 'distant' | 'environment';
  twoSided?: boolean;
  /** Up to four points of three numbers. */
  points?: ArrayLike<number>;
  direction?: ArrayLike<number>;
  radius?: number;
  cosInner?: number;
  cosOuter?: number;
  power?: number;
  userId?: number;
  linkMask?: bigint;
}

export class LightReceivers {
  constructor(count: number);
  static from(
    positions: ArrayLike<number> & { slice(first: number, end: number): ArrayLike<number> },
    normals: (ArrayLike<number> & { slice(first: number, end: number): ArrayLike<number> }) | null,
    random: ArrayLike<number>,
  ): LightReceivers;
  readonly count: number;
  /** 56 bytes a receiver, as kiwami_light_receiver of light.h. */
  readonly buffer: Buffer;
  setPosition(receiver: number, position: ArrayLike<number>): void;
  setNormal(receiver: number, normal: ArrayLike<number>): void;
  setSegment(receiver: number, segment: ArrayLike<number>): void;
  setFlags(receiver: number, flags: number): void;
  setLinkMask(receiver: number, linkMask: bigint): void;
  setRandom(receiver: number, random: number): void;
}

export class LightChoices {
  constructor(count: number);
  readonly count: number;
  /** 24 bytes a choice, as kiwami_light_choice of light.h. */
  readonly buffer: Buffer;
  lightId(choice: number): number;
  instanceId(choice: number): number;
  userId(choice: number): number;
  probability(choice: number): number;
  random(choice: number): number;
}

export class LightTree {
  constructor(device: Device, options?: { width?: number });
  addLights(lights: Light[]): number;
  addMesh(
    vertices: ArrayLike<number>,
    triangles: ArrayLike<number>,
    options?: { radiance?: number; twoSided?: boolean },
  ): number;
  setPowers(first: number, powers: ArrayLike<number>): void;
  commit(): void;
  refit(): void;
  sample(receivers: LightReceivers): LightChoices;
  pdf(receivers: LightReceivers, choices: LightChoices): Float32Array;
  close(): void;
}

/** The constants of the C interface. */
export const constants: { readonly [name: string]: number };
