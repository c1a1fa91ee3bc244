#include "itk_transforms.h"

#include <itkAffineTransform.h>
#include <itkTransformFactory.h>
#include <itkTransformFileReader.h>
#include <itkTransformFileWriter.h>
#include <itkTxtTransformIOFactory.h>
#include <itkVersorRigid3DTransform.h>

#include <stdexcept>

namespace lefort::test {
namespace {

using Transform = itk::Transform<double, 3, 3>;
using Affine = itk::AffineTransform<double, 3>;
using Versor = itk::VersorRigid3DTransform<double>;

itk::Vector<double, 3> as_vector(const ItkPoint& p) { return itk::Vector<double, 3>(p.data()); }

}  // namespace

ItkPoint apply_itk_transform(const std::string& file, const ItkPoint& point) {
  itk::TxtTransformIOFactory::RegisterOneFactory();
  itk::TransformFactory<Affine>::RegisterTransform();
  itk::TransformFactory<Versor>::RegisterTransform();
  const auto reader = itk::TransformFileReader::New();
  reader->SetFileName(file);
  reader->Update();
  if (reader->GetTransformList()->size() != 1) throw std::runtime_error("not one transform");
  const auto* const transform =
      dynamic_cast<const Transform*>(reader->GetTransformList()->front().GetPointer());
  if (transform == nullptr) throw std::runtime_error("not a transform of space");
  const auto to = transform->TransformPoint(itk::Point<double, 3>(point.data()));
  return {to[0], to[1], to[2]};
}

void write_itk_transform(const std::string& file, ItkKind kind, const ItkPoint& axis,
                         double angle_rad, const ItkPoint& center, const ItkPoint& translation) {
  itk::TxtTransformIOFactory::RegisterOneFactory();
  const auto versor = Versor::New();
  versor->SetCenter(itk::Point<double, 3>(center.data()));
  versor->SetRotation(as_vector(axis), angle_rad);
  versor->SetTranslation(as_vector(translation));
  const auto affine = Affine::New();
  affine->SetCenter(versor->GetCenter());
  affine->SetMatrix(versor->GetMatrix());
  affine->SetTranslation(versor->GetTranslation());
  const auto writer = itk::TransformFileWriter::New();
  writer->SetFileName(file);
  if (kind == ItkKind::kVersor) writer->SetInput(versor);
  if (kind == ItkKind::kAffine) writer->SetInput(affine);
  writer->Update();
}

}  // namespace lefort::test
