#include "itk_images.h"

#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkImageRegionConstIterator.h>
#include <itkMetaImageIOFactory.h>
#include <itkNiftiImageIOFactory.h>
#include <itkNrrdImageIOFactory.h>

namespace lefort::test {

ItkImage read_itk_image(const std::string& file) {
  itk::NrrdImageIOFactory::RegisterOneFactory();
  itk::NiftiImageIOFactory::RegisterOneFactory();
  itk::MetaImageIOFactory::RegisterOneFactory();
  using Image = itk::Image<double, 3>;
  const auto reader = itk::ImageFileReader<Image>::New();
  reader->SetFileName(file);
  reader->Update();
  const Image& image = *reader->GetOutput();
  ItkImage read;
  for (unsigned axis = 0; axis < 3; ++axis) {
    read.size[axis] = image.GetLargestPossibleRegion().GetSize()[axis];
    read.spacing[axis] = image.GetSpacing()[axis];
    read.origin[axis] = image.GetOrigin()[axis];
    for (unsigned column = 0; column < 3; ++column)
      read.direction[axis][column] = image.GetDirection()(axis, column);
  }
  for (itk::ImageRegionConstIterator<Image> voxel(&image, image.GetLargestPossibleRegion());
       !voxel.IsAtEnd(); ++voxel)
    read.values.push_back(voxel.Get());
  return read;
}

}  // namespace lefort::test
