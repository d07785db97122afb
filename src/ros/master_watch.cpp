#include "master_watch.h"

#include <ros/connection_manager.h>
#include <ros/console.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <optional>
#include <utility>

namespace cloth_sim {
namespace {

using XmlRpc::XmlRpcValue;

/// Calls the master's API (wiki.ros.org/ROS/Master_API) in the name of this node.
/// \return the reply; nothing if the master does not answer, or refuses.
std::optional<XmlRpcValue> ask(const std::string& method, const std::vector<std::string>& words) {
  XmlRpcValue request;
  XmlRpcValue response;
  XmlRpcValue payload;
  request[0] = ros::this_node::getName();
  for (std::size_t k = 0; k < words.size(); ++k) request[static_cast<int>(k) + 1] = words[k];
  if (!ros::master::execute(method, request, response, payload, false)) return std::nullopt;
  return payload;
}

std::string ownUri() { return ros::XMLRPCManager::instance()->getServerURI(); }

/// Calls this node's own slave API (wiki.ros.org/ROS/Slave_API), the only source of its topics.
/// \return the reply; nothing if it refuses.
std::optional<XmlRpcValue> askSelf(const std::string& method, const XmlRpcValue& request) {
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(ownUri(), host, port)) return std::nullopt;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpcValue response;  // [code, message, payload]
  const bool done = client.execute(method.c_str(), request, response) && response.size() == 3;
  client.close();
  if (!done || static_cast<int>(response[0]) != 1) return std::nullopt;
  return response[2];
}

/// Returns the list of `method` of the slave API, a pair (topic, type) each.
std::vector<std::pair<std::string, std::string>> ownTopics(const std::string& method) {
  XmlRpcValue request;
  request[0] = ros::this_node::getName();
  std::optional<XmlRpcValue> list = askSelf(method, request);
  std::vector<std::pair<std::string, std::string>> topics;
  for (int k = 0; list && k < list->size(); ++k) topics.emplace_back((*list)[k][0], (*list)[k][1]);
  return topics;
}

std::string ownServiceUri() {
  return "rosrpc://" + ros::network::getHost() + ":" +
         std::to_string(ros::ConnectionManager::instance()->getTCPPort());
}

std::vector<std::string> strings(XmlRpcValue list) {
  std::vector<std::string> texts;
  for (int k = 0; k < list.size(); ++k) texts.push_back(list[k]);
  return texts;
}

/// Names the services of this node that the master knows.
std::vector<std::string> ownServices() {
  std::vector<std::string> own;
  std::optional<XmlRpcValue> state = ask("getSystemState", {});
  if (!state) return own;
  XmlRpcValue& services = (*state)[2];  // [publishers, subscribers, services], each [name, [nodes]]
  for (int k = 0; k < services.size(); ++k) {
    for (const std::string& node : strings(services[k][1])) {
      if (node == ros::this_node::getName()) own.push_back(services[k][0]);
    }
  }
  return own;
}

}  // namespace

MasterWatch::MasterWatch(ros::NodeHandle& node)
    : services_(ownServices()),
      timer_(node.createWallTimer(ros::WallDuration(kPeriod), &MasterWatch::check, this)) {}

void MasterWatch::check(const ros::WallTimerEvent& /*event*/) {
  if (ros::isShuttingDown() || !ask("getPid", {})) return;  // there is no master
  if (ask("lookupNode", {ros::this_node::getName()})) return;
  ROS_WARN("the ROS master does not know this node: it was restarted, and is told again");
  registerAgain();
}

void MasterWatch::registerAgain() const {
  for (const std::string& service : services_) {
    ask("registerService", {service, ownServiceUri(), ownUri()});
  }
  for (const auto& [topic, type] : ownTopics("getPublications")) {
    ask("registerPublisher", {topic, type, ownUri()});
  }
  for (const auto& [topic, type] : ownTopics("getSubscriptions")) {
    const std::optional<XmlRpcValue> publishers =
        ask("registerSubscriber", {topic, type, ownUri()});
    if (!publishers) continue;
    XmlRpcValue update;
    update[0] = ros::this_node::getName();
    update[1] = topic;
    update[2] = *publishers;
    askSelf("publisherUpdate", update);
  }
}

}  // namespace cloth_sim
