// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the geometry room, for headers that only name its types.
#pragma once

namespace surfleet {
struct AnyCamera;
struct BoundaryPoint;
class BoxSolid;
class Bvh;
struct ClosestPoint;
struct Curvature;
struct DepthImage;
struct EdgeGeodesic;
struct EquidistantCamera;
struct EuclideanMetric;
struct FaceGeodesic;
class GeodesicField;
class Graph;
struct GreyImage;
class HalfEdges;
struct HalfPlane;
class KdTree;
struct KeepOut;
struct LidarModel;
struct LidarScan;
class MeshAdjacency;
struct MeshComponents;
struct OutlierOptions;
struct PinholeCamera;
struct PointCloud;
struct PlaneNormalOptions;
class PointLocator;
struct Polygon;
class PolygonClipper;
class PolygonGeodesics;
struct Prism;
struct RadialTangentialCamera;
struct RayHit;
struct ShortestPaths;
struct SimplifyOptions;
class TextScanner;
struct TriangleMesh;
}  // namespace surfleet
