/// \file
/// Moves the border of bone to where half of a voxel is bone.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/image/volume.h>

namespace lefort::anatomy {

/// Removes the blurred border of dense bone, which a threshold below half its density includes.
///
/// The border of a bone lies where the CT number is halfway between those of both sides
/// (\cite prevrhal1999): a voxel between other tissue and denser bone remains bone if its number is
/// at least the mean of soft tissue and of the densest bone within 1.5 mm. Thin bone does not lie
/// in front of denser bone, so it remains. A voxel that is removed becomes brain if the other
/// tissue is brain, else soft tissue. Islands of the mandible that this leaves become soft tissue.
///
/// \param ct       the scan.
/// \param labels   changed. \pre on the grid of `ct`.
void sharpen_bone(const image::CtVolume& ct, LabelMap& labels);

}  // namespace lefort::anatomy
