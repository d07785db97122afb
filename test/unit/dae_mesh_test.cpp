/// \file Collada files: the triangles of their scene, and refusals.

#include "scene/dae_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using testing::HasSubstr;

/// A file with one geometry of four points, (0, 0, 0), (1, 0, 0), (1, 1, 0) and (0, 1, 0).
/// \param faces  in its mesh.
/// \param scene  nodes of its scene. \param asset  what stands in `<asset>`.
std::string fileOf(const std::string& faces, const std::string& scene, const std::string& asset) {
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
         "version='1.4.1'><asset>" +
         asset +
         "</asset>\n<library_geometries><geometry id='square'><mesh>\n"
         "<source id='points'><float_array id='numbers' count='12'>0 0 0 1 0 0 <!-- here -->\n"
         "1 1 0 0 1 0</float_array><technique_common><accessor source='#numbers' count='4' "
         "stride='3'/></technique_common></source>\n"
         "<vertices id='corners'><input semantic='POSITION' source='#points'/></vertices>\n" +
         faces +
         "</mesh></geometry></library_geometries>\n<library_visual_scenes>"
         "<visual_scene id='all'>" +
         scene +
         "</visual_scene></library_visual_scenes>\n"
         "<scene><instance_visual_scene url='#all'/></scene></COLLADA>";
}

constexpr const char* kInput = "<input semantic='VERTEX' source='#corners' offset='0'/>";
constexpr const char* kInstance = "<node><instance_geometry url='#square'/></node>";

std::string facesOf(const std::string& kind, const std::string& inside) {
  return "<" + kind + ">" + kInput + inside + "</" + kind + ">";
}

Triangles parsed(const std::string& faces, const std::string& scene = kInstance,
                 const std::string& asset = "") {
  return parseDae(fileOf(faces, scene, asset), "mesh.dae");
}

const std::string kSquare = facesOf("polylist", "<vcount>4</vcount><p>0 1 2 3</p>");

double areaOf(const Triangles& it) {
  Vec3 sum = Vec3::Zero();
  for (const TriangleSurface::Triangle& t : it.corners) {
    const Vec3& a = it.vertices[t[0]];
    sum += 0.5 * (it.vertices[t[1]] - a).cross(it.vertices[t[2]] - a);
  }
  return sum.z();
}

TEST(Collada, FacesOfEveryKindMakeTheSquare) {
  for (const std::string& faces :
       {kSquare, facesOf("triangles", "<p>0 1 2 0 2 3</p>"), facesOf("polygons", "<p>0 1 2 3</p>"),
        facesOf("trifans", "<p>0 1 2 3</p>"), facesOf("tristrips", "<p>0 1 3 2</p>"),
        "<triangles><input semantic='NORMAL' source='#points' offset='0'/>"
        "<input semantic='VERTEX' source='#corners' offset='1'/><p>3 0 3 1 3 2 3 0 3 2 3 3</p>"
        "</triangles>" +
            facesOf("lines", "<p>0 1</p>")}) {
    const Triangles square = parsed(faces);
    EXPECT_EQ(square.corners.size(), 2u) << faces;
    EXPECT_EQ(square.vertices.size(), 4u) << faces;
    EXPECT_EQ(areaOf(square), 1.0) << faces;  // both turn the same way
  }
}

/// Returns the place of the corner (1, 0, 0) of the square, all of whose corners a node moves.
Vec3 placeOfX(const std::string& node, const std::string& asset = "") {
  const Triangles one = parsed(facesOf("triangles", "<p>1 1 1</p>"), node, asset);
  return one.vertices.at(0);
}

TEST(Collada, NodesMoveTheirGeometriesInTheOrderOfTheirTransforms) {
  const std::string square = "<instance_geometry url='#square'/>";
  EXPECT_EQ(placeOfX("<node><translate>0 0 2</translate>" + square + "</node>"), Vec3(1, 0, 2));
  EXPECT_EQ(placeOfX("<node><scale>2 3 4</scale><translate>1 1 1</translate>" + square + "</node>"),
            Vec3(4, 3, 4));
  EXPECT_EQ(
      placeOfX("<node><matrix>0 -1 0 5  1 0 0 6  0 0 1 7  0 0 0 1</matrix>" + square + "</node>"),
      Vec3(5, 1 + 6, 7));
  const Vec3 turned = placeOfX("<node><rotate>0 0 2 90</rotate>" + square + "</node>");
  EXPECT_LT((turned - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(placeOfX("<node><translate>0 0 1</translate><node><translate>0 1 0</translate>" +
                     square + "</node></node>"),
            Vec3(1, 1, 1));
  EXPECT_EQ(placeOfX("<node><translate>3 0 0</translate><instance_node url='#part'/></node>"
                     "<node id='part'><translate>0 3 0</translate></node>" +
                     std::string(kInstance)),
            Vec3(1, 0, 0));
}

TEST(Collada, LengthsAreInMetresAndTheUpAxisTurnsNothing) {
  EXPECT_EQ(placeOfX("<node><translate>0 4 0</translate><instance_geometry url='#square'/></node>",
                     "<unit name='half' meter='0.5'/><up_axis>Y_UP</up_axis>"),
            Vec3(0.5, 2, 0));
}

TEST(Collada, AGeometryIsInstantiatedAsOftenAsNodesDo) {
  const std::string twice =
      "<node id='a'><instance_geometry url='#square'/></node>"
      "<node><translate>0 0 1</translate><instance_node url='#a'/></node>";
  EXPECT_EQ(parsed(kSquare, twice).corners.size(), 4u);
}

TEST(Collada, WithoutASceneTheGeometriesCount) {
  std::string file = fileOf(kSquare, "", "");
  const std::size_t from = file.find("<library_visual_scenes>");
  file = file.substr(0, from) + "</COLLADA>";
  EXPECT_EQ(parseDae(file, "mesh.dae").corners.size(), 2u);
}

std::string refusalOf(const std::string& file) {
  const std::string error = testing_support::sceneErrorOf([&] { parseDae(file, "mesh.dae"); });
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  return error;
}

std::string refusalOf(const std::string& faces, const std::string& scene) {
  return refusalOf(fileOf(faces, scene, ""));
}

TEST(Collada, BadFilesAreRefusedInOneLine) {
  EXPECT_EQ(refusalOf(""), "mesh.dae: expected a Collada file (XML that is malformed)");
  EXPECT_THAT(refusalOf("<COLLADA><a></COLLADA>"), HasSubstr("mesh.dae:1: expected a Collada"));
  EXPECT_EQ(refusalOf("<robot/>"), "mesh.dae: expected a Collada file: an element <COLLADA>");
  EXPECT_EQ(refusalOf(facesOf("triangles", "<p>0 1 4</p>"), kInstance),
            "mesh.dae:6: <p>: expected an index from 0 to 4, exclusive (got 4)");
  EXPECT_THAT(refusalOf(facesOf("triangles", "<p>0 -1 2</p>"), kInstance), HasSubstr("(got -1)"));
  EXPECT_THAT(refusalOf(facesOf("triangles", "<p>0 1 x</p>"), kInstance),
              HasSubstr("expected a number (got \"x\")"));
  EXPECT_THAT(refusalOf(facesOf("triangles", "<p>0 1</p>"), kInstance),
              HasSubstr("<triangles>: expected three corners a triangle"));
  EXPECT_THAT(refusalOf(facesOf("polylist", "<vcount>5</vcount><p>0 1 2</p>"), kInstance),
              HasSubstr("as many as vcount says"));
  EXPECT_THAT(refusalOf("<triangles><p>0 1 2</p></triangles>", kInstance),
              HasSubstr("expected an input VERTEX"));
  EXPECT_THAT(
      refusalOf("<triangles><input semantic='VERTEX' source='#no'/></triangles>", kInstance),
      HasSubstr("no such source"));
  EXPECT_THAT(refusalOf(facesOf("polygons", "<ph><p>0 1 2</p></ph>"), kInstance),
              HasSubstr("without holes"));
  EXPECT_THAT(refusalOf(kSquare, "<node><instance_geometry url='#no'/></node>"),
              HasSubstr("no such geometry"));
  EXPECT_THAT(refusalOf(kSquare, "<node><matrix>1 2</matrix></node>"),
              HasSubstr("expected 16 numbers (got 2)"));
  EXPECT_THAT(refusalOf(kSquare, "<node><translate>0 nan 0</translate></node>"),
              HasSubstr("expected finite numbers"));
  EXPECT_THAT(refusalOf(kSquare, "<node><rotate>0 0 0 90</rotate></node>"),
              HasSubstr("an axis with a length"));
  EXPECT_THAT(refusalOf(fileOf(kSquare, kInstance, "<unit meter='-1'/>")),
              HasSubstr("a length in metres"));
}

TEST(Collada, AFileThatMultipliesItselfIsRefused) {
  EXPECT_THAT(refusalOf(kSquare, "<node id='a'><instance_node url='#a'/></node>"),
              HasSubstr("nodes, 200 deep"));
  std::string nodes;
  for (int k = 0; k < 30; ++k) {
    const std::string next = "<instance_node url='#n" + std::to_string(k + 1) + "'/>";
    nodes += "<node id='n" + std::to_string(k) + "'>" + next + next + "</node>";
  }
  EXPECT_THAT(refusalOf(kSquare, nodes + "<node id='n30'/>"), HasSubstr("at most 100000 nodes"));
  std::string many = "<p>";
  for (int k = 0; k < 1000; ++k) many += "0 1 2 ";
  std::string often;
  for (int k = 0; k < 201; ++k) often += kInstance;
  EXPECT_THAT(refusalOf(facesOf("triangles", many + "</p>"), often),
              HasSubstr("expected at most 200000 triangles"));
}

}  // namespace
}  // namespace cloth_sim
