#include "inputs.h"

#include "submit.h"

namespace cloth_sim {

Inputs::Inputs(ros::NodeHandle& privateNode, const RequestChecker& checker,
               SimulationThread& simulation)
    : checker_(checker), simulation_(simulation) {
  // Strokes come in pieces, and where one is lost the cloth holds together.
  subscribers_.push_back(privateNode.subscribe("cut_stroke", 1000, &Inputs::onCutStroke, this));
  // A ray replaces the one before, but no release may be lost: so a few may wait.
  subscribers_.push_back(privateNode.subscribe("drag", 10, &Inputs::onDrag, this));
  subscribers_.push_back(privateNode.subscribe("phase_command", 10, &Inputs::onPhase, this));
}

void Inputs::onCutStroke(const CutStroke& stroke) {
  submit("cut_stroke", checker_.stroke(stroke), simulation_);
}

void Inputs::onDrag(const DragRay& ray) { submit("drag", checker_.drag(ray), simulation_); }

void Inputs::onPhase(const std_msgs::String& phase) {
  submit("phase_command", SetPhase{phase.data}, simulation_);
}

}  // namespace cloth_sim
