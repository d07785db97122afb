/// \file Cloth from OBJ files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>

#include "cloth_sim/mesh/grid.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "scene/obj_mesh.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using testing::HasSubstr;

/// Two triangles over a square of 2 x 2 units.
const char* const kSquare =
    "# a comment\n"
    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "vn 0 0 1\n"
    "f 1/1/1 2/2/1 3/3/1 4/4/1\n";

ClothMesh square(const ObjUnits& units = {}) { return parseObj(kSquare, "square.obj", units); }

std::string refusal(const std::string& text) {
  return testing_support::sceneErrorOf([&] { parseObj(text, "bad.obj", {}); });
}

TEST(Obj, PolygonsBecomeFans) {
  const ClothMesh mesh = square();
  ASSERT_EQ(mesh.faces.size(), 2U);
  EXPECT_EQ(mesh.faces[0], (Face{0, 1, 2}));
  EXPECT_EQ(mesh.faces[1], (Face{0, 2, 3}));
  EXPECT_EQ(mesh.positions[2], Vec3(2.0, 2.0, 0.0));
}

TEST(Obj, UvAreScaledToTheAreaInSpaceUnlessTheSceneSays) {
  EXPECT_LT((square().material[2] - Vec2(2.0, 2.0)).norm(), 1e-15);
  ObjUnits centimetres;
  centimetres.scale = 0.01;
  EXPECT_LT((square(centimetres).material[2] - Vec2(0.02, 0.02)).norm(), 1e-17);
  EXPECT_LT((square(centimetres).positions[2] - Vec3(0.02, 0.02, 0.0)).norm(), 1e-17);
  ObjUnits given;
  given.uvScale = 3.0;
  EXPECT_EQ(square(given).material[2], Vec2(3.0, 3.0));
}

TEST(Obj, UvBeginAtZero) {
  const ClothMesh mesh = parseObj(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 5 -3\nvt 6 -3\nvt 5 -2\nf 1/1 2/2 3/3\n", "far.obj", {});
  EXPECT_LT(mesh.material[0].norm(), 1e-15);
  EXPECT_LT((mesh.material[1] - Vec2(1.0, 0.0)).norm(), 1e-15);
}

TEST(Obj, NumbersBelowZeroCountFromTheLast) {
  const ClothMesh mesh = parseObj(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf -3/-3 -2/-2 -1/-1\n", "back.obj", {});
  EXPECT_EQ(mesh.faces[0], (Face{0, 1, 2}));
}

TEST(Obj, AMirrorImageIsTurnedRound) {
  const ClothMesh mesh = parseObj(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 3/3 2/2\n", "mirror.obj", {});
  EXPECT_EQ(mesh.faces[0], (Face{0, 1, 2}));
}

TEST(Obj, ErrorsAreNamedWithTheirLine) {
  const std::string corners =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
      "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nvt 2 1\n";  // lines 1 to 10
  EXPECT_THAT(refusal(""), HasSubstr("bad.obj: expected faces"));
  EXPECT_THAT(refusal("v 0 0\n"), HasSubstr("bad.obj:1: expected \"v x y z\""));
  EXPECT_THAT(refusal("v 0 0 nan\n"), HasSubstr("bad.obj:1:"));
  EXPECT_THAT(refusal(corners + "f 1/1 2/2\n"), HasSubstr("bad.obj:11: expected a face"));
  EXPECT_THAT(refusal(corners + "f 1 2 3\n"), HasSubstr("bad.obj:11: expected corners"));
  EXPECT_THAT(refusal(corners + "f 1/1 2/2 9/3\n"), HasSubstr("bad.obj:11: there is no vertex 9"));
  EXPECT_THAT(refusal(corners + "f 1/1 2/2 3/0\n"), HasSubstr("bad.obj:11: there is no uv 0"));
  EXPECT_THAT(refusal(corners + "f 1/1 2/2 2/2\n"), HasSubstr("bad.obj:11: the face has a vertex"));
  EXPECT_THAT(refusal(corners + "f 1/1 2/2 3/3\n"), HasSubstr("bad.obj:4: the vertex has no face"));
  const std::string first = corners + "f 1/1 2/2 3/3\n";
  EXPECT_THAT(refusal(first + "f 2/3 4/4 3/3\nf 2/2 5/5 4/4\n"),
              HasSubstr("bad.obj:12: vertex 2 has two uv"));
  EXPECT_THAT(refusal(first + "f 2/2 3/3 4/4\nf 2/2 5/5 4/4\n"),
              HasSubstr("bad.obj:12: the face is turned the other way"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 2 0\nf 1/1 2/2 3/3\n"),
              HasSubstr("bad.obj:7: the face has no area in uv"));
}

TEST(Obj, OnlyManifoldsAreCloth) {
  const std::string fin =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 1 1\nv 0 2 2\n"
      "vt 0 0\nvt 1 0\nvt 0 1\nvt 0 2\nvt 0 3\n"
      "f 1/1 2/2 3/3\nf 1/1 2/2 4/4\nf 1/1 2/2 5/5\n";
  EXPECT_THAT(refusal(fin), HasSubstr("bad.obj:12: the edge from vertex 1 to 2 is also of the face "
                                      "of line 11"));
  const std::string bowtie =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv -1 0 0\nv -1 -1 0\n"
      "vt 0 0\nvt 1 0\nvt 1 1\nvt -1 0\nvt -1 -1\n"
      "f 1/1 2/2 3/3\nf 1/1 4/4 5/5\n";
  EXPECT_THAT(refusal(bowtie), HasSubstr("bad.obj:1: the vertex joins faces at a single point"));
}

/// A file in a folder of its own, and a scene beside it.
class ObjScene : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "obj_scene_";
    std::ofstream(folder_ + "square.obj") << kSquare;
  }
  void TearDown() override { std::remove((folder_ + "square.obj").c_str()); }

  Scene load(const std::string& cloth) const {
    return parseScene("cloth: {obj: " + folder_ + "square.obj, " + cloth + "}\n", "it.yaml");
  }
  std::string folder_;
};

TEST_F(ObjScene, HasTheMassOfItsAreaAndStartsWhereTheFileSays) {
  Simulation simulation(
      load("scale: 0.1, pins: [4], pose: {position: [0, 0, 1]}, fabric: {areal_density: 0.5}"));
  EXPECT_NEAR(totalMass(simulation.model()), 0.5 * 0.04, 1e-15);
  EXPECT_LT((simulation.state().x[2] - Vec3(0.2, 0.2, 1.0)).norm(), 1e-15);
  EXPECT_NEAR(simulation.observeMaxStretch(), 1.0, 1e-12) << "at rest";
  for (int k = 0; k < 15; ++k) simulation.step();
  EXPECT_FALSE(simulation.failed());
  EXPECT_EQ(simulation.state().x[3], Vec3(0.0, 0.2, 1.0)) << "the pin";
  EXPECT_LT(simulation.state().x[1].z(), 0.95);
}

TEST_F(ObjScene, RefusesWhatOnlyGridsHave) {
  const auto refused = [this](const std::string& cloth) {
    return testing_support::sceneErrorOf([&] { load(cloth); });
  };
  EXPECT_THAT(refused("size: [1, 1]"), HasSubstr("not beside obj"));
  EXPECT_THAT(refused("pins: [[0, 0]]"), HasSubstr("no columns and rows"));
  EXPECT_THAT(refused("pins: [first_row]"), HasSubstr("cloth.pins"));
  EXPECT_THAT(refused("pins: [5]"), HasSubstr("cloth.pins"));
  EXPECT_THAT(refused("scale: 0"), HasSubstr("cloth.scale"));
  EXPECT_THROW(parseScene("cloth: {obj: nowhere.obj}\n", "it.yaml"), SceneError);
  EXPECT_THROW(parseScene("cloth: {scale: 0.1}\n", "it.yaml"), SceneError);
}

/// The same cloth by a grid and by a file moves alike: the springs follow from the mesh alone.
TEST(ObjGrid, MovesAsTheGridThatItIsACopyOf) {
  const Grid grid{9, 7, 0.4, 0.3};
  const TriangleMesh mesh = makeGridMesh(grid);
  const std::string file = testing::TempDir() + "obj_grid_copy.obj";
  {
    std::ofstream out(file);
    out.precision(17);
    for (const Vec2& uv : mesh.material()) {
      out << "v " << uv.x() - 0.2 << " " << uv.y() - 0.15 << " 0\n";
      out << "vt " << uv.x() << " " << uv.y() << "\n";
    }
    for (const Face& f : mesh.faces()) {
      out << "f";
      for (const VertexId v : f) out << " " << v + 1 << "/" << v + 1;
      out << "\n";
    }
  }
  const std::string rest = ", fabric: silk, pose: {rpy: [1.2, 0, 0]}, pins: ";
  const std::string grids = "cloth: {size: [0.4, 0.3], particles: [9, 7]" + rest + "[[0, 6]]}\n";
  const std::string files = "cloth: {obj: " + file + ", uv_scale: 1" + rest + "[55]}\n";
  Simulation byGrid(parseScene(grids, "grid.yaml"));
  Simulation byFile(parseScene(files, "file.yaml"));
  std::remove(file.c_str());
  ASSERT_EQ(byFile.model().springs.count(), byGrid.model().springs.count());
  for (int k = 0; k < 30; ++k) {
    byGrid.step();
    byFile.step();
  }
  for (VertexId v = 0; v < byGrid.model().particleCount(); ++v) {
    // Springs are swept in another order, which XPBD's single sweep depends on a little.
    EXPECT_LT((byGrid.state().x[v] - byFile.state().x[v]).norm(), 5e-3);
  }
}

}  // namespace
}  // namespace cloth_sim
