#pragma once
/// \file Markers of a cloth, published as a visualization_msgs/MarkerArray without a copy.

#include <ros/serialization.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstring>
#include <memory>
#include <vector>

#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// The geometry and the colours of one side of the cloth.
struct MarkerSide {
  std::vector<geometry_msgs::Point> corners;  ///< by vertex [m]
  std::vector<std_msgs::ColorRGBA> colours;   ///< by vertex, or by face
  bool byFace = false;
};

/// A MarkerArray whose first markers are the sides of the cloth. A TRIANGLE_LIST repeats each
/// vertex for every corner of a face, six times on average. This type stores each vertex once and
/// expands the list when it serialises the message. roscpp calls that an adapted type.
struct ClothMarkers {
  visualization_msgs::MarkerArray array;  ///< the markers of the sides have no points and colours
  std::vector<MarkerSide> sides;          ///< of the first markers of `array`, in their order
  std::shared_ptr<const Topology> topology;
};

}  // namespace cloth_sim

namespace ros {
namespace message_traits {

template <>
struct IsMessage<cloth_sim::ClothMarkers> : TrueType {};
template <>
struct MD5Sum<cloth_sim::ClothMarkers> : MD5Sum<visualization_msgs::MarkerArray> {
  static const char* value(const cloth_sim::ClothMarkers&) {
    return MD5Sum<visualization_msgs::MarkerArray>::value();
  }
  using MD5Sum<visualization_msgs::MarkerArray>::value;
};
template <>
struct DataType<cloth_sim::ClothMarkers> : DataType<visualization_msgs::MarkerArray> {
  static const char* value(const cloth_sim::ClothMarkers&) {
    return DataType<visualization_msgs::MarkerArray>::value();
  }
  using DataType<visualization_msgs::MarkerArray>::value;
};
template <>
struct Definition<cloth_sim::ClothMarkers> : Definition<visualization_msgs::MarkerArray> {
  static const char* value(const cloth_sim::ClothMarkers&) {
    return Definition<visualization_msgs::MarkerArray>::value();
  }
  using Definition<visualization_msgs::MarkerArray>::value;
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<cloth_sim::ClothMarkers> {
  using Marker = visualization_msgs::Marker;
  // `writeSide` writes the fields of this version of the message one by one.
  static_assert(message_traits::MD5Sum<Marker>::static_value1 == 0x4048c9de2a16f4aeULL);
  static_assert(sizeof(geometry_msgs::Point) == 3 * sizeof(double));
  static_assert(sizeof(std_msgs::ColorRGBA) == 4 * sizeof(float));

  template <typename Stream>
  static void write(Stream& stream, const cloth_sim::ClothMarkers& markers) {
    stream.next(static_cast<std::uint32_t>(markers.array.markers.size()));
    for (std::size_t k = 0; k < markers.array.markers.size(); ++k) {
      const Marker& marker = markers.array.markers[k];
      if (k < markers.sides.size()) {
        writeSide(stream, marker, markers.sides[k], markers.topology->faces);
      } else {
        stream.next(marker);
      }
    }
  }

  static std::uint32_t serializedLength(const cloth_sim::ClothMarkers& markers) {
    std::size_t bytes = 0;
    for (const cloth_sim::MarkerSide& side : markers.sides) {
      const std::size_t colours = side.byFace ? 1 : 3;
      bytes += markers.topology->faces.size() *
               (3 * sizeof(geometry_msgs::Point) + colours * sizeof(std_msgs::ColorRGBA));
    }
    return serializationLength(markers.array) + static_cast<std::uint32_t>(bytes);
  }

 private:
  template <typename Stream>
  static void writeSide(Stream& stream, const Marker& marker, const cloth_sim::MarkerSide& side,
                        const std::vector<cloth_sim::Face>& faces) {
    stream.next(marker.header);
    stream.next(marker.ns);
    stream.next(marker.id);
    stream.next(marker.type);
    stream.next(marker.action);
    stream.next(marker.pose);
    stream.next(marker.scale);
    stream.next(marker.color);
    stream.next(marker.lifetime);
    stream.next(marker.frame_locked);
    writeCorners(stream, side.corners, faces);
    if (side.byFace) {
      writeAll(stream, side.colours);
    } else {
      writeCorners(stream, side.colours, faces);
    }
    stream.next(marker.text);
    stream.next(marker.mesh_resource);
    stream.next(marker.mesh_use_embedded_materials);
  }

  /// Copies all values at once: their layout in memory is that of the message.
  template <typename Stream, typename Value>
  static void writeAll(Stream& stream, const std::vector<Value>& values) {
    stream.next(static_cast<std::uint32_t>(values.size()));
    const std::size_t bytes = values.size() * sizeof(Value);
    std::memcpy(stream.advance(static_cast<std::uint32_t>(bytes)), values.data(), bytes);
  }

  /// Writes the value of each corner of each face.
  template <typename Stream, typename Value>
  static void writeCorners(Stream& stream, const std::vector<Value>& values,
                           const std::vector<cloth_sim::Face>& faces) {
    stream.next(static_cast<std::uint32_t>(3 * faces.size()));
    std::uint8_t* out =
        stream.advance(static_cast<std::uint32_t>(3 * faces.size() * sizeof(Value)));
    for (const cloth_sim::Face& face : faces) {
      for (const cloth_sim::VertexId v : face) {
        std::memcpy(out, &values[static_cast<std::size_t>(v)], sizeof(Value));
        out += sizeof(Value);
      }
    }
  }
};

}  // namespace serialization
}  // namespace ros
