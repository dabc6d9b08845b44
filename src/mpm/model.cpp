#include "mpm/model.hpp"

namespace brisance::mpm {

namespace {

StressOrder order_of(Body const& body, Options const& options) {
  if (options.order == StressOrder::usf) return StressOrder::usf;
  StressOrder const own = body.order.value_or(options.order);
  return own == StressOrder::usf ? options.order : own;
}

}  // namespace

/// APIC projects the velocity of the nodes around a particle on a linear function: what is left over is lost, and so is
/// what the particles around a node differ in. Both are never negative, if the energy of the gradient is counted: in a
/// fluid they are a dissipation, as by viscosity, and heat. In a solid they have an account.
BodyRules rules_of(Body const& body, Options const& options) {
  BodyRules r;
  r.order = order_of(body, options);
  r.affine = body.transfer.value_or(options.transfer) == Transfer::apic;
  r.has_gradient_energy = r.affine && options.shape == ShapeFunction::bspline && !body.rigid_velocity;
  r.keeps_energy = r.has_gradient_energy && !body.solid.has_deviator() && r.order != StressOrder::usf;
  r.settles_work = r.keeps_energy && r.order == StressOrder::usl;
  r.books_work = body.books_work && !r.keeps_energy && !body.rigid_velocity;
  return r;
}

}  // namespace brisance::mpm
