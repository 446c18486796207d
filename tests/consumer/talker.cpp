// SPDX-License-Identifier: MIT
#include <surfleet/adapters/dds_transport.hpp>

int main() {
  surfleet::DdsTransport air(0, {.domain = 72, .team = "consumer"});
  air.send({.payload = surfleet::seal({})});
  return air.receive(0).empty() ? 0 : 1;
}
