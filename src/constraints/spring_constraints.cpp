#include "spring_constraints.h"

#include "spring_forces.h"

namespace cloth_sim {

void SpringConstraints::addForces(const VectorArray& x, const VectorArray& v,
                                  VectorArray& force) const {
  addSpringForces(schedule_, x, v, force);
}

void SpringConstraints::addForce(const Element& spring, const VectorArray& x, const VectorArray& v,
                                 VectorArray& force) {
  addSpringForce(spring, x, v, force);
}

double SpringConstraints::potential(const VectorArray& x, const VectorArray& v, double tau) const {
  return springPotential(schedule_, x, v, tau);
}

}  // namespace cloth_sim
