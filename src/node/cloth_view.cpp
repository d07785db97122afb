#include "ros/viewer.h"

int main(int argc, char** argv) { return cloth_sim::runViewer(argc, argv); }
