#include <lefort/anatomy/voxel_mask.h>

#include <itkConnectedComponentImageFilter.h>
#include <itkImage.h>
#include <itkPlatformMultiThreader.h>

#include <algorithm>
#include <new>

namespace lefort::anatomy {
namespace {

template <class T>
using ItkImage = itk::Image<T, 3>;

/// Gives ITK filters access to the values without a copy; the filters do not write to their inputs.
/// Only size and spacing are set: results do not depend on origin and direction.
template <class T>
typename ItkImage<T>::Pointer itk_view(const image::Volume<T>& volume) {
  const auto view = ItkImage<T>::New();
  typename ItkImage<T>::SizeType size;
  typename ItkImage<T>::SpacingType spacing;
  for (unsigned axis = 0; axis < 3; ++axis) {
    size[axis] = itk::SizeValueType(volume.grid.size[axis]);
    spacing[axis] = volume.grid.spacing_mm[Index(axis)];
  }
  view->SetRegions(size);
  view->SetSpacing(spacing);
  view->GetPixelContainer()->SetImportPointer(const_cast<T*>(volume.values.data()),
                                              volume.values.size(), false);
  return view;
}

template <class T>
image::Volume<T> volume_from_itk(const ItkImage<T>& itk_image, const image::Grid& grid) {
  const T* first = itk_image.GetBufferPointer();
  return {grid, std::vector<T>(first, first + grid.voxel_count())};
}

Mask complement(const Mask& mask) {
  return mask_where(mask.grid, [&](std::size_t v) { return mask.values[v] == 0; });
}

}  // namespace

Index voxel_count(const Mask& mask) {
  return deterministic_sum(Index(mask.values.size()), Index(0),
                           [&](Index v) { return Index(mask.values[std::size_t(v)]); });
}

double voxel_ml(const image::Grid& grid) { return grid.spacing_mm.prod() * 1e-3; }

Mask dilated(const Mask& mask, double radius_mm) {
  const image::ScalarVolume distance = distance_to(mask, radius_mm);
  return mask_where(mask.grid,
                    [&](std::size_t v) { return double(distance.values[v]) <= radius_mm; });
}

Mask eroded(const Mask& mask, double radius_mm) {
  const image::ScalarVolume distance = distance_to(complement(mask), radius_mm);
  return mask_where(mask.grid,
                    [&](std::size_t v) { return double(distance.values[v]) > radius_mm; });
}

Mask opened(const Mask& mask, double radius_mm) {
  return dilated(eroded(mask, radius_mm), radius_mm);
}

Mask closed(const Mask& mask, double radius_mm) {
  return eroded(dilated(mask, radius_mm), radius_mm);
}

Mask dilated_by_one_voxel_or_more(const Mask& mask, double distance_mm) {
  const image::ScalarVolume distance = distance_to(mask, distance_mm);
  const std::array<Index, 3>& size = mask.grid.size;
  Mask near{mask.grid, std::vector<std::uint8_t>(mask.values.size())};
  parallel_for(size[2], [&](Index k) {
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i) {
        const auto contains = [&](Index ni, Index nj, Index nk) {
          return mask.grid.contains(ni, nj, nk) && mask.at(ni, nj, nk) != 0;
        };
        const bool adjacent = contains(i - 1, j, k) || contains(i + 1, j, k) ||
                              contains(i, j - 1, k) || contains(i, j + 1, k) ||
                              contains(i, j, k - 1) || contains(i, j, k + 1);
        near.at(i, j, k) = adjacent || double(distance.at(i, j, k)) <= distance_mm ? 1 : 0;
      }
  });
  return near;
}

std::int32_t Components::largest() const {
  if (count() == 0) return 0;
  return std::int32_t(std::max_element(voxels.begin() + 1, voxels.end()) - voxels.begin());
}

Components connected_components(const Mask& mask, Neighbors neighbors) {
  using Filter = itk::ConnectedComponentImageFilter<ItkImage<std::uint8_t>, ItkImage<std::int32_t>>;
  const auto filter = Filter::New();
  filter->SetInput(itk_view(mask));
  filter->SetFullyConnected(neighbors == Neighbors::kFacesEdgesCorners);
  // The default threader of ITK 5.2 does not wait for other threads after an exception in one.
  filter->SetMultiThreader(itk::PlatformMultiThreader::New());
  try {
    filter->Update();
  } catch (const itk::ExceptionObject&) {  // There is no other cause.
    throw std::bad_alloc();
  }

  Components parts{volume_from_itk<std::int32_t>(*filter->GetOutput(), mask.grid), {0}};
  // The numbers of ITK are in no guaranteed order; renumber by first voxels.
  std::vector<std::int32_t> renumbered(1, 0);
  for (std::int32_t& part : parts.component_of.values) {
    if (part != 0) {
      if (std::size_t(part) >= renumbered.size()) renumbered.resize(std::size_t(part) + 1, 0);
      if (renumbered[std::size_t(part)] == 0) {
        renumbered[std::size_t(part)] = std::int32_t(parts.voxels.size());
        parts.voxels.push_back(0);
      }
      part = renumbered[std::size_t(part)];
    }
    ++parts.voxels[std::size_t(part)];
  }
  return parts;
}

Mask select_components(const Components& parts, const std::vector<std::uint8_t>& keep) {
  LEFORT_CHECK(keep.size() == parts.voxels.size());
  return mask_where(parts.component_of.grid, [&](std::size_t v) {
    return keep[std::size_t(parts.component_of.values[v])] != 0;
  });
}

std::vector<std::uint8_t> components_overlapping(const Components& parts, const Mask& mask) {
  std::vector<std::uint8_t> touching(parts.voxels.size(), 0);
  for (std::size_t v = 0; v < mask.values.size(); ++v)
    if (mask.values[v] != 0) touching[std::size_t(parts.component_of.values[v])] = 1;
  touching[0] = 0;
  return touching;
}

}  // namespace lefort::anatomy
