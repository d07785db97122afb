#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
struct Start { const char* scene; double t; };
const std::vector<Start> kStarts{
    {"curtain_gusts", 0.6}, {"curtain_hover", 0.2}, {"curtain_relaxed", 0.2}, {"cut", 0.95},
    {"drape_sphere", 0.5}, {"explicit_blows_up", 0}, {"explicit_hang", 0}, {"hang", 0.0},
    {"robot_tear", 0.1}, {"rod", 0.3}, {"round_tablecloth", 0.3}, {"strip", 0}, {"table_edge", 0.1},
    {"tear_seam", atof(getenv("TS") ? getenv("TS") : "0.5")}, {"tear_seam_explicit", 0.5}, {"two_cloths", 0.5}, {"weak_grip", 0.8}, {"wind", 0.3}};

Scene load(const std::string& name) { return loadScene(std::string(CLOTH_SIM_SOURCE_DIR) + "/config/scenes/" + name + ".yaml"); }

struct Probe {
  double u = 0, uMean = 0, virial = 0, hold = 0, res = 0;
};
Probe probe(const Simulation& s, const std::vector<Vec3>& vBefore, double dt) {
  const Model& m = s.model();
  const State& st = s.state();
  std::vector<Vec3> f(m.particleCount(), Vec3::Zero());
  std::vector<double> k(m.particleCount(), 0.0);
  double win = 0;
  for (const Spring& sp : m.springs.slots()) {
    if (!sp.exists()) continue;
    Vec3 d = st.x[sp.b] - st.x[sp.a];
    double l = d.norm();
    Vec3 n = d / l;
    double t = sp.stiffness * (l - sp.restLength) + sp.damping * n.dot(st.v[sp.b] - st.v[sp.a]);
    f[sp.a] += t * n;
    f[sp.b] -= t * n;
    win += t * l;
    if (sp.kind != SpringKind::kBend) for (VertexId v : {sp.a, sp.b}) k[v] = std::max(k[v], sp.stiffness * sp.restLength);
  }
  std::vector<char> skip(m.particleCount(), 0);
  double wext = 0;
  Probe p;
  const auto& kin = s.lastReport().reactions;
  std::vector<VertexId> held;
  for (const Clamp& c : s.clamps()) for (const auto& h : c.held()) held.push_back(h);
  (void)kin;
  for (VertexId v : held) skip[v] = 1;
  for (const auto& c : s.contacts().candidates) for (VertexId v : c.vertices) skip[v] = 1;
  double sum = 0, n = 0, all=0, bal=0;
  for (VertexId v = 0; v < m.particleCount(); ++v) {
    Vec3 a = v < (int)vBefore.size() ? Vec3((st.v[v] - vBefore[v]) / dt) : Vec3::Zero();
    if (st.v[v].norm() == 0.0) continue;  // pins
    Vec3 r = f[v] + m.mass[v] * (s.scene().gravity - a);
    wext -= m.mass[v] * (s.scene().gravity - a).dot(st.x[v]);
    if (skip[v] || k[v] == 0) continue;
    double u = r.norm() / k[v];
    p.u = std::max(p.u, u);
    sum += u; n += 1; all += f[v].norm(); bal += r.norm();
  }
  p.uMean = sum / std::max(1.0, n);
  p.virial = bal/all;
  return p;
}

struct Result {
  std::string out = "ended";
  std::string why;
  double un = 0; std::string warn;
  int frames = 0, substeps = 0;
  double rms = 0, strain = 0, cost = 0, maxStrain = 0;
  std::vector<std::vector<Vec3>> x;
  std::vector<double> strains;
  Probe pr, prMin;
};

Result run(Scene scene, const std::string& bytes, int frames, double budget) {
  Result r;
  const double t0 = now();
  try {
    Simulation s(scene);
    if (!bytes.empty()) s.adopt(bytes);
    r.prMin.u = 1e9;
    for (int k = 0; k < frames && !s.failed(); ++k) {
      std::vector<Vec3> v = s.state().v.values();
      s.step();
      r.substeps = s.lastReport().substeps;
      if (k == 0) frames = std::min<int>(frames, std::max(3.0, budget / (1.0 * s.model().particleCount() * r.substeps)));
      if (s.failed()) break;
      r.x.push_back(s.state().x.values());
      r.strains.push_back(maxStretch(s.model(), s.state()) - 1);
      r.maxStrain = std::max(r.maxStrain, r.strains.back());
      r.frames = k + 1;
      Probe p = probe(s, v, scene.solver.dt);
      p.res = s.lastReport().residual;
      if (k + 1 > frames / 2) { r.pr.u = std::max(r.pr.u, p.u); r.prMin.u = std::min(r.prMin.u, p.u); r.pr.uMean = p.uMean; r.pr.virial = p.virial; r.pr.res = p.res; }
    }
    r.un = s.unexplainedStrain(); r.warn = s.warning().empty() ? "" : "WARN";
    if (s.failed()) { r.out = "failed"; r.why = s.failure(); }
  } catch (const std::exception& e) { r.out = "refused"; r.why = e.what(); }
  r.cost = now() - t0;
  return r;
}

TEST(MethodMatrix, Probe) {
  const char* only = getenv("SCENE");
  const char* om = getenv("METHOD");
  int frames = getenv("FRAMES") ? atoi(getenv("FRAMES")) : 20;
  double budget = getenv("BUDGET") ? atof(getenv("BUDGET")) : 4e6;
  for (const Start& start : kStarts) {
    if (only && start.scene != std::string(only)) continue;
    const double startTime = start.t;
    Scene own = load(start.scene);
    own.solver.sleep.reset();
    std::string bytes;
    double t0 = now();
    if (startTime > 0) {
      Simulation s(own);
      while (s.time() < startTime && !s.failed()) s.step();
      bytes = s.save();
      printf("# %s start t=%.2f phase %s cost %.2f fail '%s'\n", start.scene, s.time(), s.script().history().empty() ? "" : s.script().history().back().name.c_str(), now() - t0, s.failure().c_str());
    }
    Scene ref = own;
    ref.solver.method = "verlet";
    ref.solver.guard = StepGuard::kSubdivide;
    ref.solver.parameters = completeParameters(findSolver("verlet"), {});
    Result R = run(ref, bytes, frames, budget * 20);
    printf("# %s reference: %s %s frames %d substeps %d strain %.4g cost %.2f u %.3g/%.3g vir %.3g\n", start.scene, R.out.c_str(), R.why.c_str(), R.frames, R.substeps, R.strains.empty() ? 0 : R.strains.back(), R.cost, R.pr.u, R.pr.uMean, R.pr.virial);
    fflush(stdout);
    auto report = [&](const std::string& label, const Result& r) {
      int f = std::min(r.frames, R.frames);
      double rms = -1, sr = 0, st = 0, moved = 0;
      if (f > 0) {
        const auto& a = r.x[f - 1]; const auto& b = R.x[f - 1]; const auto& c = R.x[0];
        size_t n = std::min({a.size(), b.size(), c.size()});
        double sum = 0, m2 = 0;
        for (size_t k = 0; k < n; ++k) { sum += (a[k] - b[k]).squaredNorm(); m2 += (b[k] - c[k]).squaredNorm(); }
        rms = std::sqrt(sum / n); moved = std::sqrt(m2 / n);
        sr = R.strains[f - 1]; st = r.strains[f - 1];
      }
      printf("%-18s %-28s %-8s f %2d sub %4d rms %8.2e (moved %7.1e) strain %8.3g ref %8.3g | max %8.3g u %8.2e min %8.2e mean %8.2e vir %8.2e res %8.2e cost %.2f un %.3f %s %s\n", start.scene, label.c_str(), r.out.c_str(), r.frames, r.substeps, rms, moved, st, sr, r.maxStrain, r.pr.u, r.prMin.u, r.pr.uMean, r.pr.virial, r.pr.res, r.cost, r.un, r.warn.c_str(), r.why.substr(0, 90).c_str());
      fflush(stdout);
    };
    Scene fine = own;
    fine.solver.method = "line_xpbd";
    fine.solver.parameters = completeParameters(findSolver("line_xpbd"), {{"substeps", 200.0}});
    report("line_xpbd200", run(fine, bytes, frames, budget * 20));
    for (const SolverInfo& info : solverRegistry()) {
      if (om && info.name != om) continue;
      Scene scene = own;
      scene.solver.method = info.name;
      if (info.name != own.solver.method) scene.solver.parameters = completeParameters(info, {});
      report(info.name + (info.name == own.solver.method ? "*" : ""), run(scene, bytes, frames, budget));
      if (std::isinf(info.stabilityLimit)) continue;
      scene.solver.guard = StepGuard::kSubdivide;
      report(info.name + "_guard", run(scene, bytes, frames, budget));
    }
  }
}

}  // namespace
}  // namespace cloth_sim
