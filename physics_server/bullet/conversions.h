#pragma once

#include <btBulletDynamicsCommon.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mascot {

// Bullet is built with double precision: no bits are lost.
inline btVector3 ToBullet(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3d ToEigen(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Matrix3d ToEigen(const btMatrix3x3& m) {
  return Eigen::Matrix3d{
      {m[0].x(), m[0].y(), m[0].z()}, {m[1].x(), m[1].y(), m[1].z()}, {m[2].x(), m[2].y(), m[2].z()}};
}
// Bullet's quaternions are x, y, z, w; the constructor of Eigen's takes w, x, y, z.
inline btQuaternion ToBullet(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }
inline Eigen::Quaterniond ToEigen(const btQuaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }

}  // namespace mascot
