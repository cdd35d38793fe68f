#pragma once
#include <thread>

namespace etalon {

/// Loads what pictures are read and written with, 0.2 s of it, on a thread of its own, for a picture that is still to
/// be computed; the thread is waited for when it goes. Nothing is thrown: who needs it then says what is wrong.
std::jthread load_pictures_ahead();

}  // namespace etalon
